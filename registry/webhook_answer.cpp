// SPDX-License-Identifier: Apache-2.0
#include "registry/webhook_answer.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <ctime>
#include <iomanip>
#include <limits>
#include <locale>
#include <sstream>
#include <vector>

namespace asip::registry {
namespace {

constexpr auto kNone = std::string_view::npos;
constexpr std::string_view kHttp = "HTTP/1.";
constexpr std::size_t kShort = 4;  // what is shorter is no secret

/// The first line, without its end; the rest is behind it.
std::string_view take_line(std::string_view& text) {
    const auto end = text.find('\n');
    auto line = text.substr(0, end);
    text.remove_prefix(end == kNone ? text.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

/// Where the body begins.
std::size_t end_of_heads(std::string_view text) {
    auto rest = text;
    while (!rest.empty())
        if (take_line(rest).empty()) return text.size() - rest.size();
    return kNone;
}

template <class Number>
std::optional<Number> number(std::string_view text) {
    Number value{};
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (fault == std::errc::result_out_of_range) return std::numeric_limits<Number>::max();
    return fault == std::errc{} ? std::optional(value) : std::nullopt;
}

std::optional<int> status_of(std::string_view line) {
    if (!line.starts_with(kHttp) || line.size() < 12) return std::nullopt;
    return number<int>(line.substr(9, 3));
}

bool same_name(std::string_view one, std::string_view other) {
    return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                      [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
}

/// Retry-After: seconds, or a time.
Duration wait_of(std::string_view text, std::chrono::system_clock::time_point now) {
    using std::chrono::seconds;
    const auto at_most = std::chrono::duration_cast<seconds>(WebhookAnswer::kMaxWait).count();
    auto wait = number<long long>(text);
    if (!wait) {
        std::istringstream stream{std::string(text)};
        stream.imbue(std::locale::classic());
        std::tm time{};
        stream >> std::get_time(&time, "%a, %d %b %Y %H:%M:%S GMT");
        if (!stream.fail()) wait = timegm(&time) - std::chrono::system_clock::to_time_t(now);
    }
    return seconds(std::clamp<long long>(wait.value_or(0), 0, at_most));
}

/// The server alone: the rest may hold a key.
std::string new_server(std::string_view location) {
    const auto address = parse_webhook(std::string(location));
    return address ? ", at " + address->server.text() : std::string();
}

/// What of the address a receiver may say again and nobody else is to read: each part of its path and query,
/// and the password.
std::vector<std::string> secrets(const WebhookAddress& asked) {
    constexpr std::string_view kBetween = "/?&=;";
    std::vector<std::string> found;
    const auto note = [&](std::string_view part) {
        if (part.size() >= kShort) found.emplace_back(part);
    };
    for (const auto& all : {asked.target, percent_decoded(asked.target).value_or("")}) {
        note(all);
        for (std::size_t at = 0, end = 0; end != kNone; at = end + 1) {
            end = all.find_first_of(kBetween, at);
            note(std::string_view(all).substr(at, end - at));
        }
    }
    note(std::string_view(asked.user).substr(asked.user.find(':') + 1));
    note(basic(asked.user));
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    return found;
}

/// One at the end may be cut off.
std::string without_secrets(std::string text, const WebhookAddress& asked) {
    for (const auto& secret : secrets(asked)) {
        for (auto at = text.find(secret); at != kNone; at = text.find(secret, at))
            text.replace(at, secret.size(), "...");
        for (auto size = secret.size() - 1; size >= kShort; --size)
            if (text.ends_with(std::string_view(secret).substr(0, size)))
                text.replace(text.size() - size, size, "...");
    }
    return text;
}

/// Without a character of UTF-8 that is cut off at the end.
std::string_view whole_characters(std::string_view text) {
    auto last = text.size();
    while (last > 0 && (text[last - 1] & 0xC0) == 0x80)
        --last;
    if (last == 0) return text;
    const auto lead = static_cast<unsigned char>(text[last - 1]);
    const std::size_t size = lead < 0xC0 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
    return lead >= 0xC0 && last - 1 + size > text.size() ? text.substr(0, last - 1) : text;
}

}  // namespace

void WebhookAnswer::add(std::string_view bytes) {
    text_ += bytes.substr(0, kMaxBytes - std::min(kMaxBytes, text_.size()));
}

/// The part with the status that counts.
std::string_view WebhookAnswer::last() const {
    std::string_view text = text_;
    for (;;) {
        auto rest = text;
        const auto status = status_of(take_line(rest));
        if (!status || *status / 100 != 1) return text;
        const auto end = end_of_heads(text);
        if (end == kNone) return {};
        text.remove_prefix(end);
    }
}

std::string_view WebhookAnswer::body() const {
    auto text = last();
    const auto end = end_of_heads(text);
    text.remove_prefix(end == kNone ? text.size() : end);
    if (same_name(head("transfer-encoding"), "chunked")) take_line(text);
    return text;
}

std::string_view WebhookAnswer::head(std::string_view name) const {
    auto text = last();
    take_line(text);
    for (auto line = take_line(text); !line.empty(); line = take_line(text)) {
        const auto colon = line.find(':');
        if (colon == kNone || !same_name(line.substr(0, colon), name)) continue;
        line.remove_prefix(std::min(line.find_first_not_of(" \t", colon + 1), line.size()));
        return line.substr(0, line.find_last_not_of(" \t") + 1);
    }
    return {};
}

bool WebhookAnswer::complete() const {
    const auto text = last();
    if (!kHttp.starts_with(text.substr(0, kHttp.size())) || text_.size() >= kMaxBytes) return true;
    if (end_of_heads(text) == kNone) return false;
    auto rest = text;
    const auto status = status_of(take_line(rest));
    if (!status || *status / 100 == 2) return true;
    const auto length = number<std::size_t>(head("content-length")).value_or(kMaxWords);
    return body().size() >= std::min(kMaxWords, length);
}

std::optional<WebhookAnswer::Verdict> WebhookAnswer::verdict(
    const WebhookAddress& asked, std::chrono::system_clock::time_point now) const {
    auto rest = last();
    if (rest.empty()) return std::nullopt;
    const auto status = status_of(take_line(rest));
    if (!status) return Verdict{WebhookResult::kFailed, "what answers there does not speak HTTP", {}};
    if (*status / 100 == 2) return Verdict{WebhookResult::kDelivered, {}, {}};
    // Too slow, too often: later.
    const bool later = *status < 300 || *status >= 500 || *status == 408 || *status == 425 || *status == 429;
    Verdict verdict{later ? WebhookResult::kFailed : WebhookResult::kRefused,
                    "it answered with status " + std::to_string(*status),
                    {}};
    if (*status < 400 && !later) verdict.why += ", another address" + new_server(head("location"));
    if (later) verdict.wait = wait_of(head("retry-after"), now);
    auto words = without_secrets(std::string(body()), asked);
    std::replace_if(words.begin(), words.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
    words.resize(whole_characters(std::string_view(words).substr(0, kMaxWords)).size());
    words.resize(words.find_last_not_of(' ') + 1);
    if (!words.empty()) verdict.why += ": " + words;
    return verdict;
}

}  // namespace asip::registry
