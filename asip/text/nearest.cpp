// SPDX-License-Identifier: Apache-2.0
#include "asip/text/nearest.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

namespace asip::text {
namespace {

constexpr std::size_t kMaxComparedBytes = 128;
constexpr std::size_t kMinBeginningBytes = 3;

bool same_letter(char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

bool begins_with(std::string_view text, std::string_view beginning) {
    return text.size() >= beginning.size() &&
           std::equal(beginning.begin(), beginning.end(), text.begin(), same_letter);
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
    a = a.substr(0, kMaxComparedBytes);
    b = b.substr(0, kMaxComparedBytes);
    std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j)
        row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before_last.swap(last);
        last.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t change = same_letter(a[i - 1], b[j - 1]) ? 0 : 1;
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + change});
            const bool swapped =
                i > 1 && j > 1 && same_letter(a[i - 1], b[j - 2]) && same_letter(a[i - 2], b[j - 1]);
            if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
        }
    }
    return row[b.size()];
}

std::optional<std::size_t> misspelling_distance(std::string_view word, std::string_view candidate) {
    if (word.empty()) return std::nullopt;
    const auto distance = edit_distance(word, candidate);
    if (distance < word.size() && distance <= (word.size() + 2) / 3) return distance;
    if (word.size() >= kMinBeginningBytes && begins_with(candidate, word)) return 1;
    return std::nullopt;
}

}  // namespace asip::text
