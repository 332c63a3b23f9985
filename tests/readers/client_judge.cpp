// SPDX-License-Identifier: Apache-2.0
#include "tests/readers/client_judge.hpp"

#include <algorithm>
#include <functional>
#include <optional>

namespace readers {

namespace {

constexpr std::size_t kMaxRequest = 250;  // of a board with the extension for long requests
constexpr std::size_t kMaxFrame = 4096;
constexpr std::size_t kTag = 3;  // `S,t`

bool is_letter(char c) {
    return c >= 'A' && c <= 'Z';
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Without what is skipped before and behind a request.
std::string_view trimmed(std::string_view text) {
    const auto is_skipped = [](char c) { return static_cast<unsigned char>(c) <= ' '; };
    while (!text.empty() && is_skipped(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_skipped(text.back()))
        text.remove_suffix(1);
    return text;
}

bool is_ignored(std::string_view text) {
    return text.empty() || text.front() == '!';
}

enum class Rule : std::uint8_t { kIgnored, kRefused, kExecuted, kEither };

/// `S,t[,...]`.
Rule form_of(std::string_view text) {
    const bool has_form = text.size() >= kTag && (is_letter(text[0]) || text[0] == '#') && text[1] == ',' &&
                          text[2] > ' ' && text[2] <= '~' && (text.size() == kTag || text[kTag] == ',');
    if (!has_form || text.find('\0') != text.npos) return Rule::kRefused;
    // `S,,` may be a request of the tag `,`.
    if (text[2] == ',') return Rule::kEither;
    const bool plain = std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
    return plain && text.size() <= kMaxRequest ? Rule::kExecuted : Rule::kEither;
}

/// How many numbers these requests of published services have (docs/services.md).
std::optional<std::size_t> numbers_of(char service, char tag) {
    if (tag == 'A') return 1;
    struct Form {
        char service;
        std::string_view tags;
        std::size_t numbers;
    };
    for (const auto& form :
         {Form{'I', "dPa", 2}, Form{'M', "mMac", 2}, Form{'M', "rR", 3}, Form{'M', "s", 1}, Form{'N', "B", 2},
          Form{'N', "C", 5}, Form{'N', "S", 1}, Form{'S', "W", 2}, Form{'T', "P", 2}})
        if (form.service == service && form.tags.find(tag) != form.tags.npos) return form.numbers;
    return std::nullopt;
}

/// An optional sign and digits, blanks around them.
bool is_number(std::string_view text) {
    text = trimmed(text);
    if (text.starts_with('-')) text.remove_prefix(1);
    return !text.empty() && std::all_of(text.begin(), text.end(), is_digit);
}

/// Whether a request that no line end ends looks whole.
Rule wholeness(std::string_view text) {
    const auto form = form_of(text);
    if (form != Rule::kExecuted) return form;
    if (text[0] == 'L' && text[2] != 'A') return Rule::kExecuted;  // its requests hold text
    const auto needed = numbers_of(text[0], text[2]);
    // Published clients send `M,E,`.
    if (!needed && text.size() == kTag + 1) return Rule::kExecuted;
    if (text.back() == ',' && text.size() > kTag) return Rule::kRefused;
    std::size_t good = 0, bad = 0;
    for (auto rest = text.substr(kTag); !rest.empty();) {
        rest.remove_prefix(1);
        const auto comma = std::min(rest.find(','), rest.size());
        ++(is_number(rest.substr(0, comma)) ? good : bad);
        rest.remove_prefix(comma);
    }
    if (!needed) return bad == 0 ? Rule::kExecuted : Rule::kEither;
    if (good + bad < *needed) return Rule::kRefused;
    return bad == 0 && good == *needed ? Rule::kExecuted : Rule::kEither;
}

}  // namespace

bool ClientJudge::splits_before_last(bool& certain) const {
    if (extended_ || text_.size() <= kTag || text_[0] == '#' || text_[0] == '!' || text_[0] == 'L')
        return false;
    const char letter = text_.back();
    certain = is_letter(text_[0]) && text_[1] == ',' && is_letter(letter);
    return is_letter(letter) || letter == '#';
}

bool ClientJudge::may_end_at(std::uint8_t byte) const {
    if (framing_ == Framing::kFrames) return length_bytes_ == 2 || byte == 0;
    bool certain = false;
    return byte == '\n' || (byte == ',' && splits_before_last(certain));
}

const char* ClientJudge::byte(std::uint8_t byte, const std::vector<Outcome>& seen) {
    if (framing_ == Framing::kUnknown) framing_ = byte == 0 ? Framing::kFrames : Framing::kLines;
    return framing_ == Framing::kFrames ? byte_of_frame(byte, seen) : byte_of_line(byte, seen);
}

const char* ClientJudge::byte_of_line(std::uint8_t byte, const std::vector<Outcome>& seen) {
    const char* wrong = nullptr;
    bool certain = false;
    if (byte == '\n' || byte == '\r') {
        wrong = end(text_, End::kLine, seen);
        text_.clear();
    } else if (byte == ',' && splits_before_last(certain) && (certain || !seen.empty())) {
        const char next = text_.back();
        text_.pop_back();
        wrong = end(text_, End::kNext, seen);
        text_ = {next, ','};
    } else {
        if (!seen.empty()) wrong = "it did something in the middle of a request";
        if (!text_.empty() || byte > ' ') text_ += static_cast<char>(byte);
    }
    return wrong;
}

const char* ClientJudge::byte_of_frame(std::uint8_t byte, const std::vector<Outcome>& seen) {
    if (length_bytes_ < 2) {
        length_ = length_ << 8 | byte;
        ++length_bytes_;
        if (length_bytes_ == 2 && length_ == 0) length_bytes_ = 0;
        return seen.empty() ? nullptr : "it did something in the length of a frame";
    }
    text_ += static_cast<char>(byte);
    if (text_.size() < length_) return seen.empty() ? nullptr : "it did something in the middle of a frame";
    std::vector<Outcome> left = seen;
    const char* wrong = nullptr;
    const bool is_dropped = length_ > kMaxFrame && seen.empty();
    for (std::string_view rest = text_; !is_dropped && !rest.empty() && wrong == nullptr;) {
        const auto size = std::min(rest.find_first_of("\r\n"), rest.size());
        const auto line = rest.substr(0, size);
        rest.remove_prefix(std::min(size + 1, rest.size()));
        std::vector<Outcome> of_line;
        if (!is_ignored(trimmed(line)) && !left.empty()) {
            of_line.push_back(left.front());
            left.erase(left.begin());
        }
        wrong = end(line, End::kLine, of_line);
    }
    text_.clear();
    length_bytes_ = 0;
    length_ = 0;
    return wrong != nullptr || left.empty() ? wrong : "it did more than the frame says";
}

const char* ClientJudge::second_of_silence(const std::vector<Outcome>& seen) {
    if (framing_ != Framing::kLines || extended_ || text_.empty())
        return seen.empty() ? nullptr : "it did something in silence";
    const char* const wrong = end(text_, End::kSilence, seen);
    text_.clear();
    return wrong;
}

const char* ClientJudge::end(std::string_view text, End end, const std::vector<Outcome>& seen) {
    text = trimmed(text);
    auto rule = is_ignored(text) ? Rule::kIgnored : end == End::kLine ? form_of(text) : wholeness(text);
    // Half of a name looks whole.
    if (end == End::kSilence && text.starts_with('#') && text.size() > kTag) rule = Rule::kRefused;
    if (rule == Rule::kIgnored) return seen.empty() ? nullptr : "it did something where nothing was asked";
    if (text.size() > kMaxRequest && seen.empty()) return nullptr;  // dropped, and counted
    if (end == End::kLine)
        for (const std::string_view extension : {"#,E", "#,X", "#,I"})
            if (text.starts_with(extension)) extended_ = true;
    if (seen.size() != 1)
        return seen.empty() ? "it did nothing with a request" : "one request, and it did two things";
    if (seen[0].refused) return rule == Rule::kExecuted ? "it refused a good request" : nullptr;
    if (rule == Rule::kRefused) return "it executed a bad request";
    return seen[0].text == text ? nullptr : "it executed something else";
}

std::size_t ClientJudge::hash() const {
    return std::hash<std::string>()(text_) ^ static_cast<std::size_t>(framing_) << 1 ^
           static_cast<std::size_t>(extended_) << 3 ^ static_cast<std::size_t>(length_bytes_) << 4 ^
           static_cast<std::size_t>(length_) << 6;
}

}  // namespace readers
