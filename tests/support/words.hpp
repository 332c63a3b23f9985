// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sstream>
#include <string>
#include <vector>

namespace asip::test {

/// The words of a text, or its parts between `at`: a list that takes a few lines.
inline std::vector<std::string> words(const std::string& text, char at = ' ') {
    std::vector<std::string> all;
    std::istringstream stream(text);
    for (std::string word; std::getline(stream, word, at);)
        all.push_back(word);
    return all;
}

}  // namespace asip::test
