// SPDX-License-Identifier: Apache-2.0
#include "cli/text/terminal_buffer.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>

#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

const std::string& mark() {
    static const std::string drawn = [] {
        std::random_device random;
        std::array<char, 24> text{};
        std::snprintf(text.data(), text.size(), "\033%08x%08x", random(), random());
        return std::string(text.data());
    }();
    return drawn;
}

/// Bytes of a character of UTF-8 that begins so; 1 where none does.
std::size_t bytes_of(char first) {
    const auto byte = static_cast<unsigned char>(first);
    return byte >= 0xf0 ? 4 : byte >= 0xe0 ? 3 : byte >= 0xc2 ? 2 : 1;
}

/// How many bytes at the end may be the beginning of a mark or of a character.
std::size_t unfinished(std::string_view text) {
    const auto& own = mark();
    for (auto size = std::min(text.size(), own.size() - 1); size > 0; --size)
        if (std::string_view(own).starts_with(text.substr(text.size() - size))) return size;
    for (std::size_t size = 1; size <= std::min<std::size_t>(text.size(), 3); ++size)
        if (bytes_of(text[text.size() - size]) > size) return size;
    return 0;
}

void append_shown(std::string& shown, std::string_view text) {
    const auto stays = [](char c) { return (c >= 0x20 && c < 0x7f) || c == '\n' || c == '\t'; };
    while (!text.empty()) {
        const auto end = std::find_if_not(text.begin(), text.end(), stays);
        const auto plain = static_cast<std::size_t>(end - text.begin());
        shown += text.substr(0, plain);
        const auto next = std::find_if(end, text.end(), stays);
        const auto odd = static_cast<std::size_t>(next - end);
        if (odd > 0) shown += for_terminal(text.substr(plain, odd));
        text.remove_prefix(plain + odd);
    }
}

}  // namespace

std::string own_control(char character) {
    return mark() + character;
}

TerminalBuffer::~TerminalBuffer() {
    pass({}, true);
}

bool TerminalBuffer::pass(std::string_view text, bool all) {
    const auto whole = waiting_.empty() ? std::string() : std::exchange(waiting_, {}) + std::string(text);
    auto rest = whole.empty() ? text : std::string_view(whole);
    std::string shown;
    for (auto own = rest.find(mark()); own != std::string_view::npos; own = rest.find(mark())) {
        const auto end = own + mark().size();
        if (end == rest.size()) break;
        append_shown(shown, rest.substr(0, own));
        shown += rest[end];
        rest.remove_prefix(end + 1);
    }
    const auto kept = all ? 0 : rest.ends_with(mark()) ? mark().size() : unfinished(rest);
    append_shown(shown, rest.substr(0, rest.size() - kept));
    waiting_ = rest.substr(rest.size() - kept);
    const auto size = static_cast<std::streamsize>(shown.size());
    return size == 0 || target_->sputn(shown.data(), size) == size;
}

std::streamsize TerminalBuffer::xsputn(const char* text, std::streamsize size) {
    return pass({text, static_cast<std::size_t>(size)}, false) ? size : 0;
}

TerminalBuffer::int_type TerminalBuffer::overflow(int_type character) {
    if (traits_type::eq_int_type(character, traits_type::eof())) return traits_type::not_eof(character);
    const char one = traits_type::to_char_type(character);
    return pass({&one, 1}, false) ? character : traits_type::eof();
}

int TerminalBuffer::sync() {
    return pass({}, true) && target_->pubsync() == 0 ? 0 : -1;
}

}  // namespace asip::cli
