// SPDX-License-Identifier: Apache-2.0
#include "asip/session/fences.hpp"

#include <utility>

#include "asip/protocol/body.hpp"
#include "asip/protocol/extensions.hpp"
#include "asip/protocol/request.hpp"

namespace asip::session {

namespace {

constexpr std::string_view kDigits = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";

}  // namespace

bool Fence::is_answered_by(const protocol::Event& event) const {
    if (!sent() || event.service != line[0] || event.tag != line[2]) return false;
    return token.empty() || token == fence_token(event);
}

std::string_view fence_token(const protocol::Event& event) {
    if (event.service != '#') return {};
    if (event.tag == protocol::kEcho) return event.body;
    return event.tag == protocol::kVerifiedFence ? event.body.substr(0, event.body.find(','))
                                                 : std::string_view{};
}

std::optional<std::int64_t> fence_digest(const protocol::Event& event) {
    return protocol::parse_integer(event.body.substr(event.body.find(',') + 1));
}

Fences::Fences(const Random& random)
    : second_(protocol::kAskServiceNames),
      token_(static_cast<std::uint32_t>(random() % kTokens)),
      stride_(static_cast<std::uint32_t>(random() % kTokens) | 1) {
    // Without a divisor in common with 62, the stride visits every token before one repeats.
    while (stride_ % 31 == 0)
        stride_ += 2;
}

void Fences::use_questions(std::string second) {
    echo_ = false;
    second_ = std::move(second);
}

bool Fences::is_fence_question(std::string_view line) const {
    return !echo_ && (line == protocol::kAskInfo || line == second_);
}

Fence Fences::next_but(std::string_view avoid) {
    second_next_ = avoid == protocol::kAskInfo;
    return next();
}

Fence Fences::next() {
    if (!echo_) {
        const bool second = std::exchange(second_next_, !second_next_);
        return {second ? second_ : std::string(protocol::kAskInfo), {}};
    }
    token_ = (token_ + stride_) % kTokens;
    std::string token(kTokenBytes, '0');
    std::uint32_t rest = token_;
    for (char& digit : token)
        digit = kDigits[std::exchange(rest, rest / 62) % 62];
    std::string line = verified_ ? protocol::verified_fence(token) : protocol::echo(token);
    return {std::move(line), std::move(token)};
}

}  // namespace asip::session
