// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::program {

struct ConfigLine {
    int number = 0;  ///< in the file, from 1
    std::string name;
    std::string value;
};

/// Without blanks, tabs and carriage returns at its ends.
std::string trimmed(std::string_view text);

struct ConfigSection {
    int number = 0;     ///< of its first line in the file, from 1
    std::string title;  ///< may be empty
    std::vector<ConfigLine> lines;
};

struct ConfigFile {
    std::vector<ConfigLine> lines;  ///< that hold for the program
    std::vector<ConfigSection> sections;
};

/// The lines before any section, those of `[PROGRAM]` and, with a `kind`, the sections `[KIND TITLE]`. `_` in
/// a name is read as `-`; values may stand in double quotes; `#` and `;` begin comments. Fails, with file and
/// line, on a file that is unreadable or above 1 MiB, and on a line without `=` or `]`; with a `kind` also on
/// another section than of that kind or of a program.
Expected<ConfigFile> read_config_file(const std::string& path, std::string_view program,
                                      std::string_view kind = {});

}  // namespace asip::program
