// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace asip::program {

/// First of all in main(). Opens missing standard streams, whose numbers would go to a board or a broker;
/// reading and printing there fails as before, except for standard error. SIGPIPE does not end the process.
void prepare_process();

/// As many open files as the system allows: the usual limit is for select(). Returns the number; 1024:
/// unknown.
std::size_t allow_many_open_files();

}  // namespace asip::program
