// SPDX-License-Identifier: Apache-2.0
#include "asip/program/open_files.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

namespace asip::program {

void prepare_process() {
    std::signal(SIGPIPE, SIG_IGN);
    for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(file, F_GETFD) != -1) continue;
        // The lowest number that is free is this one.
        static_cast<void>(open("/dev/null", file == STDOUT_FILENO ? O_RDONLY : O_WRONLY));
    }
}

std::size_t allow_many_open_files() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    getrlimit(RLIMIT_NOFILE, &limit);
    return limit.rlim_cur;
}

}  // namespace asip::program
