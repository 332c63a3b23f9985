// SPDX-License-Identifier: Apache-2.0
#include "tests/support/patterns.hpp"

#include <regex>

namespace asip::test {

std::optional<Match> first_match(const std::string& text, const std::string& pattern) {
    const auto all = all_matches(text, pattern);
    if (all.empty()) return std::nullopt;
    return all.front();
}

std::vector<Match> all_matches(const std::string& text, const std::string& pattern) {
    const std::regex regex(pattern);
    std::vector<Match> all;
    for (std::sregex_iterator each(text.begin(), text.end(), regex), end; each != end; ++each)
        all.emplace_back(each->begin(), each->end());
    return all;
}

std::string without_matches(const std::string& text, const std::string& pattern) {
    return std::regex_replace(text, std::regex(pattern), "");
}

}  // namespace asip::test
