#include "cli/context.hpp"

#include <ostream>

#include "cli/text/width.hpp"

namespace asip::cli {

void Context::note(const std::string& text) const {
    out.flush();
    err << "asipctl: " << printable(text) << std::endl;
}

int Context::fail_with(const Failure& failure) const {
    note(failure.text);
    return failure.status;
}

}  // namespace asip::cli
