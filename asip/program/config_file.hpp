// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::program {

/// One `name = value` of a configuration file.
struct ConfigLine {
    int number = 0;  ///< in the file, from 1
    std::string name;
    std::string value;
};

/// Without blanks, tabs and carriage returns at its ends.
std::string trimmed(std::string_view text);

/// The lines of a configuration file that hold for `program`: those before any section, and those of the
/// section `[PROGRAM]`. `_` in a name is read as `-`; a value may stand in double quotes; lines that begin
/// with `#` or `;` are comments. Fails, with file and line, on a file that cannot be read or is larger than
/// 1 MiB, a line without `=`, and a section without `]`.
Expected<std::vector<ConfigLine>> read_config_file(const std::string& path, std::string_view program);

}  // namespace asip::program
