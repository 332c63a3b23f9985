// SPDX-License-Identifier: Apache-2.0
#include "asip/model/names.hpp"

#include <algorithm>
#include <array>

#include "asip/text/printable.hpp"

namespace asip::model {
namespace {

constexpr std::array<std::string_view, 2> kReserved = {"servicebus", "registry"};

bool is_name_byte(char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
}

bool is_reserved(std::string_view name) {
    return std::find(kReserved.begin(), kReserved.end(), name) != kReserved.end();
}

// A folder in a path and in a web address: a program that asked for the board would get something else.
bool is_folder(std::string_view name) {
    return name == "." || name == "..";
}

std::string quoted(std::string_view text) {
    return "'" + text::printable(text) + "'";
}

}  // namespace

bool valid_name(std::string_view name) {
    return !name.empty() && name.size() <= kMaxNameBytes && !is_folder(name) &&
           std::all_of(name.begin(), name.end(), is_name_byte);
}

bool valid_board_name(std::string_view name) {
    return valid_name(name) && !is_reserved(name);
}

std::string explain_board_name(std::string_view name) {
    if (name.empty()) return "the name is empty";
    if (name.size() > kMaxNameBytes)
        return quoted(name) + " is " + std::to_string(name.size()) + " bytes long; at most 64 are allowed";
    if (is_reserved(name)) return quoted(name) + " is reserved";
    if (is_folder(name)) return quoted(name) + " is a folder in paths and addresses, and no name";
    if (valid_name(name)) return {};
    return quoted(name) + " is not a name: allowed are letters, digits and . _ -";
}

std::string suggest_name(std::string_view text) {
    constexpr std::size_t kLongest = 4096;  // of what is looked at
    if (text.size() > kLongest) text.remove_prefix(text.size() - kLongest);
    std::string name;
    for (const char c : text)
        if (is_name_byte(c))
            name += c;
        else if (!name.empty() && name.back() != '-')
            name += '-';
    while (!name.empty() && name.back() == '-')
        name.pop_back();
    if (name.size() > kMaxNameBytes) {
        // A port's name begins with its maker, and ends with serial number and interface.
        constexpr std::size_t kBegin = 12;
        std::string_view end = std::string_view(name).substr(name.size() - (kMaxNameBytes - kBegin - 2));
        std::string_view begin = std::string_view(name).substr(0, kBegin);
        while (!begin.empty() && (begin.back() == '-' || begin.back() == '_'))
            begin.remove_suffix(1);
        while (!end.empty() && (end.front() == '-' || end.front() == '_'))
            end.remove_prefix(1);
        name = std::string(begin) + "--" + std::string(end);
    }
    if (name.empty() || is_folder(name)) return "board";
    return is_reserved(name) ? name + "-board" : name;
}

}  // namespace asip::model
