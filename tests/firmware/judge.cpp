// SPDX-License-Identifier: Apache-2.0
#include "tests/firmware/judge.hpp"

#include <array>
#include <charconv>
#include <cstring>

#include "tests/firmware/arguments.hpp"

namespace wire {

namespace {

constexpr auto kCrc = [] {
    std::array<std::uint16_t, 256> table{};
    for (unsigned byte = 0; byte < table.size(); ++byte) {
        unsigned crc = byte;
        for (int bit = 0; bit < 8; ++bit)
            crc = crc & 1 ? crc >> 1 ^ 0x8408 : crc >> 1;
        table[byte] = static_cast<std::uint16_t>(crc);
    }
    return table;
}();

bool is_letter(char c) {
    return c >= 'A' && c <= 'Z';
}

std::string_view without_blanks_at_end(std::string_view text) {
    while (!text.empty() && text.back() == ' ')
        text.remove_suffix(1);
    return text;
}

int hex(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                  : -1;
}

/// Takes `*HH` from the end of a line: false where it is not there or is not right.
bool take_checksum(std::string_view& line) {
    if (line.size() < 3 || line[line.size() - 3] != '*') return false;
    const int high = hex(line[line.size() - 2]);
    const int low = hex(line.back());
    line.remove_suffix(3);
    int sum = 0;
    for (const char c : line)
        sum ^= static_cast<unsigned char>(c);
    return high >= 0 && low >= 0 && sum == high * 16 + low;
}

/// The only line of what was sent, without line end and checksum: empty where it is not one line.
std::string_view only_line(std::string_view sent) {
    if (sent.empty() || sent.find('\n') != sent.size() - 1) return {};
    sent.remove_suffix(1);
    if (!sent.empty() && sent.back() == '\r') sent.remove_suffix(1);
    auto bare = sent;
    return take_checksum(bare) ? bare : sent;
}

}  // namespace

bool Judge::splits_before_last(bool& certain) const {
    // `LETTER,` behind the tag; text_ ends with the letter.
    if (extended_ || lost_ || length_ < 4 || text_[0] == '!') return false;
    const char letter = text_[length_ - 1u];
    certain = is_letter(text_[0]) && text_[1] == ',' && is_letter(letter) && length_ <= kMaxRequest;
    if (text_[0] == 'E') return false;  // its requests hold text
    return is_letter(letter) || letter == '#';
}

bool Judge::may_end_at(std::uint8_t byte) const {
    bool certain = false;
    return byte == '\n' || byte == '\r' || (byte == ',' && splits_before_last(certain));
}

const char* Judge::byte(std::uint8_t byte, const Seen& seen) {
    if (byte == '\n' || byte == '\r') return end_of_line(seen);
    bool certain = false;
    const bool splits = byte == ',' && splits_before_last(certain);
    if (splits && (certain || !seen.sent.empty() || seen.calls != 0)) {
        const char next = text_[length_ - 1u];
        --length_;
        if (const char* wrong = end(seen, text(), false)) return wrong;
        drop_line();
        append(static_cast<std::uint8_t>(next));
        append(byte);
        return nullptr;
    }
    if (!seen.sent.empty() || seen.calls != 0) return "it did something in the middle of a request";
    if (seen.digest != digest_) return "the digest changed in the middle of a request";
    if (byte == 0 && (extended_ || length_ != 0)) {
        drop_line();
        lost_ = true;
    } else if (!lost_ && (length_ != 0 || byte > ' ')) {
        append(byte);
    }
    return nullptr;
}

const char* Judge::second_of_silence(const Seen& seen) {
    const bool nothing = seen.sent.empty() && seen.calls == 0;
    if (extended_ || (length_ == 0 && !lost_)) return nothing ? nullptr : "it did something in silence";
    // Half of a name or of a token looks whole.
    if (length_ > 3 && text_[0] == '#') lost_ = true;
    if (const char* wrong = end(seen, text(), false)) return wrong;
    drop_line();
    return nullptr;
}

const char* Judge::end_of_line(const Seen& seen) {
    const char* wrong = end(seen, text(), true);
    drop_line();
    return wrong;
}

void Judge::append(std::uint8_t byte) {
    if (length_ == text_.size())
        too_long_ = true;
    else
        text_[length_++] = static_cast<char>(byte);
}

void Judge::drop_line() {
    std::memset(text_.data(), 0, length_ + 1u < text_.size() ? length_ + 1u : text_.size());
    length_ = 0;
    too_long_ = lost_ = false;
}

struct Judge::Verdict {
    enum Kind { kIgnored, kRefused, kExecuted, kEither } kind;
    int error = -1;      ///< -1: any
    bool counts = true;  ///< in the digest
    Arguments arguments{};
};

const char* Judge::end(const Seen& seen, std::string_view request, bool at_line_end) {
    request = without_blanks_at_end(request);
    if (lost_ || too_long_) {
        // The digest of what is left of such a line is one that its sender does not expect.
        if (seen.calls != 0) return "it executed a line of which bytes were lost";
        digest_ = seen.digest;
        const bool ignored = request.empty() || request.starts_with('!');
        return (ignored && seen.sent.empty()) || only_line(seen.sent).starts_with('~') ? nullptr : "no error";
    }
    if (request.empty() || request.starts_with('!')) return judge({.kind = Verdict::kIgnored}, request, seen);
    if (checksums_ && (!take_checksum(request) || request.empty()))
        return judge({.kind = Verdict::kRefused, .error = 10, .counts = false}, "#,C", seen);
    auto rules = verdict(request, at_line_end);
    if (length_ > kMaxRequest || request.size() > (checksums_ ? kMaxChecked : kMaxRequest)) {
        if (rules.kind == Verdict::kExecuted) rules.kind = Verdict::kEither;
        rules.error = -1;
        if (seen.calls == 0 && only_line(seen.sent).starts_with('~')) {
            digest_ = seen.digest;
            return nullptr;
        }
    }
    return judge(rules, request, seen);
}

Judge::Verdict Judge::verdict(std::string_view request, bool at_line_end) const {
    const bool well_formed =
        request.size() >= 3 && request[1] == ',' && (request.size() == 3 || request[3] == ',');
    const char service = request[0];
    if (service != 'C' && service != 'E' && service != 'I' && service != '#')
        return {.kind = Verdict::kRefused, .error = 1};
    if (!well_formed) return {.kind = Verdict::kRefused, .error = 2};
    if (!at_line_end && service != 'E' && request.size() > 3 && request.back() == ',')
        return {.kind = Verdict::kRefused, .error = request[2] == 'm' ? 11 : -1};
    if (service == '#') return verdict_of_system(request);
    if (service == 'I' && request[2] != 'd') return {.kind = Verdict::kEither};
    if (service == 'I') return verdict_of_write(request);
    if (request[2] != 'm') return {.kind = Verdict::kRefused, .error = 2};
    const auto arguments =
        service == 'C' ? arguments_of_numbers(request.substr(3)) : arguments_of_text(request.substr(3));
    const auto kind = arguments.are == Arguments::kWrong  ? Verdict::kRefused
                      : arguments.are == Arguments::kGood ? Verdict::kExecuted
                                                          : Verdict::kEither;
    return {.kind = kind, .error = 11, .arguments = arguments};
}

/// At start the free digital pins of this board, 2 to 13, are inputs, which may be written; 0 and 1 are the
/// line's.
Judge::Verdict Judge::verdict_of_write(std::string_view request) const {
    constexpr std::int32_t kFirstPin = 2, kLastPin = 13, kMaxLevel = 255;
    auto arguments = arguments_of_pin(request.substr(3));
    if (arguments.are == Arguments::kWrong || arguments.second > kMaxLevel)
        return {.kind = Verdict::kRefused, .error = 11};
    if (arguments.first < kFirstPin || arguments.first > kLastPin) return {.kind = Verdict::kRefused};
    arguments.second = arguments.second != 0;
    return {.kind = arguments.are == Arguments::kGood ? Verdict::kExecuted : Verdict::kEither,
            .error = 11,
            .arguments = arguments};
}

Judge::Verdict Judge::verdict_of_system(std::string_view request) const {
    const char tag = request[2];
    const auto rest = request.substr(3);
    switch (tag) {
        case '?':
        case 'N':
        case 'S':
        case 'X':
        case 'R':
            return rest.empty() ? Verdict{.kind = Verdict::kExecuted}
                                : Verdict{.kind = Verdict::kRefused, .error = 11};
        case 'E':
        case 'V':
            return is_token(rest)                          ? Verdict{.kind = Verdict::kExecuted}
                   : is_token(without_blanks_at_end(rest)) ? Verdict{.kind = Verdict::kEither}
                                                           : Verdict{.kind = Verdict::kRefused, .error = 11};
        case 'C': {
            const auto number = Number::of(rest.empty() ? rest : rest.substr(1), false);
            if (rest.empty() || number.is == Arguments::kWrong || number.value > 1)
                return {.kind = Verdict::kRefused, .error = 11};
            return {.kind = number.is == Arguments::kGood ? Verdict::kExecuted : Verdict::kEither};
        }
        case 'I':
        case 'B':
            return {.kind = Verdict::kEither};
        default:
            return {.kind = Verdict::kRefused, .error = 2};
    }
}

const char* Judge::judge(const Verdict& verdict, std::string_view request, const Seen& seen) {
    const bool nothing = seen.sent.empty() && seen.calls == 0;
    // A restart sets each pin.
    const bool has_calls =
        !request.starts_with("#,R") && (!request.starts_with('I') || request.starts_with("I,d"));
    if (has_calls && seen.calls > 1) return "it executed a request twice";
    const char* wrong = nullptr;
    if (verdict.kind == Verdict::kIgnored) {
        wrong = nothing ? nullptr : "it did something where nothing was asked";
    } else if (only_line(seen.sent).starts_with('~')) {
        wrong = verdict.kind == Verdict::kExecuted ? "it refused a good request"
                                                   : refused(verdict, request, seen);
    } else if (verdict.kind == Verdict::kRefused) {
        wrong = nothing ? "a bad request has no answer" : "it executed a bad request";
    } else {
        if (has_calls && request[0] != '#') {
            const auto& is = verdict.arguments;
            const auto& call = seen.call;
            if (seen.calls != 1 || !seen.sent.empty() || call.service != request[0])
                return "it did not execute it";
            if (call.first != is.first || call.second != is.second || call.text != is.text)
                return "it executed something else";
        }
        wrong = executed(request, seen);
    }
    if (wrong) return wrong;
    return seen.digest == digest_ ? nullptr : "the digest is of something else";
}

const char* Judge::refused(const Verdict& verdict, std::string_view request, const Seen& seen) {
    const auto line = only_line(seen.sent);  // ~S,t,NUMBER{TEXT}
    const char first = request[0];
    if (seen.calls != 0 && first != 'I') return "it refused and executed a request";
    if (line.size() < 8 || line[2] != ',' || line[4] != ',' || line.back() != '}') return "not an error";
    int number = -1;
    const auto [end, code] = std::from_chars(line.data() + 5, line.data() + line.size(), number);
    if (code != std::errc{} || *end != '{') return "an error without number";
    if (line[1] != (first > ' ' && first < 0x7F ? first : '?')) return "an error of another service";
    if (verdict.error >= 0 && number != verdict.error) return "another error";
    if (verdict.counts) count(request, static_cast<unsigned>(number));
    return nullptr;
}

/// What was executed was right; what it changes here.
const char* Judge::executed(std::string_view request, const Seen& seen) {
    count(request, 0);
    const char tag = request[2];
    if (request[0] == 'I' && (tag == 'P' || tag == 'a' || tag == 'A')) can_tell_ = false;
    if (request[0] != '#') return nullptr;
    const auto line = only_line(seen.sent);
    const auto answer = line.size() > 4 ? line.substr(1) : std::string_view{};
    if (tag == 'C') checksums_ = extended_ = Number::of(request.substr(4), false).value == 1;
    if (tag == 'R' || tag == 'C') return seen.sent.empty() ? nullptr : "an answer to what has none";
    if (tag == 'B' && request != "#,B,57600") can_tell_ = false;
    if (tag == 'B') extended_ = request != "#,B,57600";
    if (!line.starts_with("@#,") || line[3] != tag) return "another answer";
    if (tag == 'E' && answer != without_blanks_at_end(request)) return "another token";
    if (tag == 'V') {
        const auto token = without_blanks_at_end(request);
        unsigned digest = 0;
        if (!answer.starts_with(token) || answer.size() < token.size() + 2) return "another token";
        std::from_chars(answer.data() + token.size() + 1, answer.data() + answer.size(), digest);
        if (digest != digest_) return "its digest is of something else";
        digest_ = 0;
    }
    if (tag == 'E' || tag == 'V') extended_ = true;
    return nullptr;
}

std::uint16_t Judge::digest_of(std::uint16_t digest, std::uint8_t byte) {
    return static_cast<std::uint16_t>(digest >> 8 ^ kCrc[(digest ^ byte) & 255]);
}

void Judge::count(std::string_view request, unsigned error) {
    for (const char c : request)
        digest_ = digest_of(digest_, static_cast<std::uint8_t>(c));
    digest_ = digest_of(digest_, 0);
    digest_ = static_cast<std::uint16_t>(digest_ ^ error);
}

}  // namespace wire
