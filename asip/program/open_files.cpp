// SPDX-License-Identifier: Apache-2.0
#include "asip/program/open_files.hpp"

#include <sys/resource.h>

namespace asip::program {

std::size_t allow_many_open_files() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    getrlimit(RLIMIT_NOFILE, &limit);
    return limit.rlim_cur;
}

}  // namespace asip::program
