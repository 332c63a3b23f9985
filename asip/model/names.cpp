#include "asip/model/names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

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

std::string quoted(std::string_view text) {
    return "'" + printable(text) + "'";
}

char lower(char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

}  // namespace

bool valid_name(std::string_view name) {
    return !name.empty() && name.size() <= kMaxNameBytes &&
           std::all_of(name.begin(), name.end(), is_name_byte);
}

bool valid_board_name(std::string_view name) {
    return valid_name(name) && !is_reserved(name);
}

std::string explain_board_name(std::string_view name) {
    if (name.empty()) return "the name is empty";
    if (name.size() > kMaxNameBytes) {
        return quoted(name) + " is " + std::to_string(name.size()) + " bytes long; at most 64 are allowed";
    }
    if (is_reserved(name)) return quoted(name) + " is reserved";
    if (valid_name(name)) return {};
    return quoted(name) + " is no name: allowed are letters, digits and . _ -";
}

std::string suggest_name(std::string_view text) {
    std::string name;
    for (const char c : text) {
        if (name.size() == kMaxNameBytes) break;
        if (is_name_byte(c)) {
            name += c;
        } else if (!name.empty() && name.back() != '-') {
            name += '-';
        }
    }
    while (!name.empty() && name.back() == '-')
        name.pop_back();
    if (name.empty()) return "board";
    return is_reserved(name) ? name + "-board" : name;
}

std::string printable(std::string_view text, std::size_t max_bytes) {
    static constexpr std::string_view kDigits = "0123456789abcdef";
    std::string result;
    for (const char c : text.substr(0, max_bytes)) {
        if (c >= 0x20 && c <= 0x7e && c != '\\') {
            result += c;
            continue;
        }
        const auto byte = static_cast<unsigned char>(c);
        result += "\\x";
        result += kDigits[byte >> 4];
        result += kDigits[byte & 0xf];
    }
    return text.size() > max_bytes ? result + "..." : result;
}

bool is_showable(std::string_view text) {
    unsigned char before = 0;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7f) return false;
        if (before == 0xc2 && byte >= 0x80 && byte <= 0x9f) return false;  // U+0080 to U+009F
        before = byte;
    }
    return true;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // What is compared are names: longer texts are nobody's slip, and cost the product of their lengths.
    a = a.substr(0, kMaxNameBytes);
    b = b.substr(0, kMaxNameBytes);
    std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j)
        row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before_last.swap(last);
        last.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t change = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + change});
            const bool swapped =
                i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
        }
    }
    return row[b.size()];
}

}  // namespace asip::model
