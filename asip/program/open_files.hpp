// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace asip::program {

/// First of all in main().
/// Opens what this process was started without of standard input, output and error: what it opens itself
/// would get their numbers, and what it prints would go to a board or a broker. Reading from and printing to
/// what was closed fails as before, except that messages to standard error are dropped.
/// A write to a broker or a reader that has gone fails and is reported; SIGPIPE does not end the process.
void prepare_process();

/// Lets this process have as many files and connections open as the system allows: the usual, lower limit is
/// for programs that use select(). Returns how many; 1024 where the system does not say.
std::size_t allow_many_open_files();

}  // namespace asip::program
