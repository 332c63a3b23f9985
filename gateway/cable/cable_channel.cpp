// SPDX-License-Identifier: Apache-2.0
#include "gateway/cable/cable_channel.hpp"

#include <utility>

namespace asip::gateway {
namespace {

using link::CableKind;

constexpr std::size_t kOneMessage = std::size_t{16} * 1024;
constexpr std::uint16_t kEnded = 1000;
constexpr std::uint16_t kNotAllowed = 1008;
constexpr std::uint16_t kTaken = 4001;  // its page connects no more: each would end the other for ever
constexpr const char* kUnplugged = "the board was unplugged from the computer that lent it";

}  // namespace

CableChannel::CableChannel(Streams& streams, Dependencies dependencies, Principal principal,
                           std::string client)
    : OpenStream(std::move(principal), std::move(client)),
      streams_(streams),
      dependencies_(std::move(dependencies)),
      counted_(dependencies_.now().time),
      said_(counted_) {
    streams_.add(*this);
    way_ = dependencies_.open({[this](const link::CableMessage& message) { from_agent(message); },
                               [this](const std::string& why) { end(why, kEnded); }});
    way_->send(CableKind::kHello, dependencies_.hello);
}

CableChannel::~CableChannel() {
    streams_.remove(*this);
    if (code_ == 0) way_->send(CableKind::kEnd, why_);
    dependencies_.ended(why_);
}

void CableChannel::from_agent(const link::CableMessage& message) {
    if (code_ != 0) return;
    if (message.kind == CableKind::kEnd) return end(message.payload, kEnded);
    if (message.kind == CableKind::kTaken) return end(message.payload, kTaken);
    if (message.kind == CableKind::kName) dependencies_.named(message.payload);
    put(message.kind, message.payload);
    if (waiting_ > kMaxWaiting) end("the browser that lent it takes no bytes", kEnded);
}

// Bytes that wait for a slow browser make one message.
void CableChannel::put(CableKind kind, std::string_view payload) {
    const char first = static_cast<char>(kind);
    if (kind == CableKind::kBytes && !out_.empty() && out_.back().front() == first &&
        out_.back().size() + payload.size() <= kOneMessage)
        out_.back() += payload;
    else
        out_.emplace_back(1, first).append(payload);
    waiting_ += payload.size();
    wake();
}

bool CableChannel::take(std::string& message) {
    if (out_.empty()) return false;
    message = std::move(out_.front());
    out_.pop_front();
    waiting_ -= message.size() - 1;
    return true;
}

bool CableChannel::within_rate(std::size_t bytes) {
    const auto now = dependencies_.now().time;
    const std::chrono::duration<double> passed = now - std::exchange(counted_, now);
    credit_ = std::min<double>(kMaxWaiting, credit_ + passed.count() * kBytesPerSecond) -
              static_cast<double>(bytes);
    return credit_ >= 0;
}

bool CableChannel::received(std::string_view message) {
    if (code_ != 0) return true;
    if (message.empty()) return false;
    const auto payload = message.substr(1);
    if (message.front() == static_cast<char>(CableKind::kEnd)) {
        end(kUnplugged, kEnded);
        return true;
    }
    if (message.front() != static_cast<char>(CableKind::kBytes) || payload.size() > link::kMaxCablePayload)
        return false;
    if (!within_rate(payload.size()))
        end("its browser sent more than 1 Mbit/s", kNotAllowed);
    else if (way_->unsent_bytes() > kMaxWaiting)
        end("the agent of lent boards takes no bytes", kEnded);
    else
        way_->send(CableKind::kBytes, payload);
    return true;
}

// What the page is to know leaves ahead of the close.
std::uint16_t CableChannel::close_code() const {
    return out_.empty() ? code_ : 0;
}

// A page does not see pings: without a network its socket stays open for minutes.
void CableChannel::tick(const Instant& now) {
    if (code_ != 0 || !out_.empty() || now.time < said_ + kAlive) return;
    said_ = now.time;
    put(CableKind::kAlive, {});
}

void CableChannel::revoke() {
    end("the right to lend it has ended", kNotAllowed);
}

// The agent is told now: a browser that reads nothing may keep this here for a while.
void CableChannel::end(const std::string& why, std::uint16_t code) {
    if (code_ != 0) return;
    out_.clear();
    waiting_ = 0;
    why_ = why;
    code_ = code;
    way_->send(CableKind::kEnd, why);
    put(CableKind::kEnd, why);
}

}  // namespace asip::gateway
