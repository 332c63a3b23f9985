// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace asip::program {

/// It stands in a folder of PATH.
bool is_in_path(const std::string& name);
/// The file may be executed.
bool is_program(const std::string& path);

}  // namespace asip::program
