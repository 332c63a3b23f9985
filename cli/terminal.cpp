// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

namespace asip::cli {

std::size_t terminal_width(int descriptor) {
    if (::isatty(descriptor) == 0) return 0;
    winsize size{};
    if (::ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
    return std::max<std::size_t>(20, size.ws_col);
}

bool knows_escapes(const std::optional<std::string>& term) {
    return !term.value_or("").empty() && term != "dumb";
}

bool use_colour(ColourChoice choice, bool terminal,
                const std::function<std::optional<std::string>(const std::string&)>& variables) {
    if (choice != ColourChoice::kAuto) return choice == ColourChoice::kAlways;
    if (!terminal || variables("NO_COLOR").value_or("") != "") return false;
    return knows_escapes(variables("TERM"));
}

}  // namespace asip::cli
