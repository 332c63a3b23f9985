// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace asip::program {

/// Lets this process have as many files and connections open as the system allows: the usual, lower limit is
/// for programs that use select(). Returns how many; 1024 where the system does not say.
std::size_t allow_many_open_files();

}  // namespace asip::program
