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

/// A section `[KIND TITLE]` of a configuration file.
struct ConfigSection {
    int number = 0;     ///< of its first line in the file, from 1
    std::string title;  ///< may be empty
    std::vector<ConfigLine> lines;
};

struct ConfigFile {
    std::vector<ConfigLine> lines;  ///< that hold for the program
    std::vector<ConfigSection> sections;
};

/// What holds for `program` in a configuration file: the lines before any section, and those of the section
/// `[PROGRAM]`; and, where `kind` is not empty, its sections `[KIND TITLE]` in their order. `_` in a name is
/// read as `-`; a value may stand in double quotes; lines that begin with `#` or `;` are comments. Fails,
/// with file and line, on a file that cannot be read or is larger than 1 MiB, a line without `=`, and a
/// section without `]`; with a `kind` also on a section that is neither of that kind nor of a program
/// (`asip...`).
Expected<ConfigFile> read_config_file(const std::string& path, std::string_view program,
                                      std::string_view kind = {});

}  // namespace asip::program
