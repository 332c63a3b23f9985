// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "asip/text/printable.hpp"

namespace asip::generate {
namespace {

// Besides the keywords, lower-case words that are macros: of g++ (linux, unix) and of the C library (errno,
// ...).
constexpr std::string_view kCppWords =
    " alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t "
    "char32_t class co_await co_return co_yield compl concept const const_cast consteval constexpr "
    "constinit continue decltype default delete do double dynamic_cast else enum errno explicit export "
    "extern false float for friend goto if inline int linux long mutable namespace new noexcept not "
    "not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires return "
    "short signed sizeof static static_assert static_cast stderr stdin stdout struct switch template "
    "this thread_local throw true try typedef typeid typename typeof union unix unsigned using virtual "
    "void volatile wchar_t while xor xor_eq ";

// What generated firmware calls by these names where arguments stand.
constexpr std::string_view kFirmwareWords = " request index error asip item pin ";

// The same in clients in C++.
constexpr std::string_view kClientWords = " request answer event expected place item ";

bool is_one_of(std::string_view words, const std::string& name) {
    return words.find(' ' + name + ' ') != std::string_view::npos;
}

std::vector<std::string> words_of(std::string_view name) {
    std::vector<std::string> words(1);
    for (const char c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            words.back() += c;
        else if (!words.back().empty())
            words.emplace_back();
    if (words.back().empty()) words.pop_back();
    return words;
}

std::string visible(std::string_view text) {
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
        const auto byte = static_cast<unsigned char>(text[at]);
        if (byte < 0x20 || byte == 0x7f || text::begins_unseen(text.substr(at))) {
            result += '?';
            at += byte < 0x80 ? 1 : byte < 0xe0 ? 2 : 3;
        } else {
            result += text[at++];
        }
    }
    return result;
}

}  // namespace

std::string pascal_case(std::string_view name) {
    std::string result;
    for (auto& word : words_of(name)) {
        word.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(word.front())));
        result += word;
    }
    return result;
}

std::string camel_case(std::string_view name) {
    auto result = pascal_case(name);
    result.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(result.front())));
    return is_one_of(kCppWords, result) || is_one_of(kFirmwareWords, result) ? result + '_' : result;
}

std::string snake_case(std::string_view name) {
    return fmt::format("{}", fmt::join(words_of(name), "_"));
}

std::string cpp_name(std::string_view name) {
    auto result = snake_case(name);
    return is_one_of(kCppWords, result) || is_one_of(kClientWords, result) ? result + '_' : result;
}

void Scope::add(const std::string& name, const std::string& origin) {
    const auto [place, added] = origins_.emplace(name, origin);
    if (added || !fault_.empty()) return;
    fault_ =
        fmt::format("{} and {} both become {} in {}: rename one", place->second, origin, name, language_);
}

std::string comment(std::string_view text) {
    auto result = visible(text);
    for (std::size_t at = 0; (at = result.find("??", at)) != std::string::npos;)
        result.erase(at, 1);
    while (!result.empty() && (result.back() == '\\' || result.back() == ' '))
        result.pop_back();
    return result;
}

std::string cpp_character(char c) {
    return c == '\'' || c == '\\' ? fmt::format("'\\{}'", c) : fmt::format("'{}'", c);
}

std::string string_literal(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            result += fmt::format("\\{}", c);
        else if (c == '?')  // two of them and another would be one character
            result += "\\?";
        else if (byte < 0x20 || byte >= 0x7f)
            result += fmt::format("\\{:03o}", byte);
        else
            result += c;
    }
    return result + '"';
}

}  // namespace asip::generate
