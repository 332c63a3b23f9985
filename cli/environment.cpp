// SPDX-License-Identifier: Apache-2.0
#include "cli/environment.hpp"

#include <poll.h>

#include <ostream>

#include "cli/text/width.hpp"

namespace asip::cli {

bool Environment::reader_gone() const {
    if (out_descriptor < 0) return false;
    pollfd watched{out_descriptor, 0, 0};
    return ::poll(&watched, 1, 0) == 1 && (watched.revents & (POLLERR | POLLHUP)) != 0;
}

bool Environment::output_ended() const {
    return !out || reader_gone();
}

void Environment::say(const std::string& text) const {
    out << for_terminal(text) << std::endl;
}

void Environment::note(const std::string& text) const {
    out.flush();
    err << "asipctl: " << for_terminal(text) << std::endl;
}

int Environment::fail_with(const Failure& failure) const {
    if (failure.text != kInterrupted || !reader_gone()) note(failure.text);
    return failure.status;
}

}  // namespace asip::cli
