// SPDX-License-Identifier: Apache-2.0
#include "cli/text/line_template.hpp"

#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

char escaped(char c) {
    if (c == 'n') return '\n';
    if (c == 't') return '\t';
    return c;
}

}  // namespace

Expected<LineTemplate> LineTemplate::parse(std::string_view text) {
    LineTemplate result;
    std::string plain;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const char next = i + 1 < text.size() ? text[i + 1] : '\0';
        if (c == '\\' && next != '\0') {
            plain += escaped(next);
            ++i;
        } else if ((c == '{' || c == '}') && next == c) {
            plain += c;
            ++i;
        } else if (c == '}') {
            return fail("'}' without '{' before it; write }} for a brace");
        } else if (c == '{') {
            const auto end = text.find('}', i);
            if (end == std::string_view::npos) return fail("'{' is never closed; write {{ for a brace");
            if (end == i + 1) return fail("{} names nothing");
            if (!plain.empty()) result.pieces_.push_back({false, std::exchange(plain, {})});
            result.pieces_.push_back({true, std::string(text.substr(i + 1, end - i - 1))});
            i = end;
        } else {
            plain += c;
        }
    }
    if (!plain.empty()) result.pieces_.push_back({false, std::move(plain)});
    return result;
}

std::string LineTemplate::fill(const std::function<std::string(std::string_view name)>& value_of) const {
    std::string line;
    for (const auto& piece : pieces_)
        line += piece.is_name ? for_terminal(value_of(piece.text)) : piece.text;
    return line;
}

std::vector<std::string> LineTemplate::names() const {
    std::vector<std::string> result;
    for (const auto& piece : pieces_)
        if (piece.is_name) result.push_back(piece.text);
    return result;
}

}  // namespace asip::cli
