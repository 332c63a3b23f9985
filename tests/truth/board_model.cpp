// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/board_model.hpp"

#include <algorithm>
#include <utility>

namespace truth {

namespace {
constexpr std::size_t kBuffer = 63;
}  // namespace

void BoardModel::restart(Micros now, Micros when) {
    reports_.state(kOff);
    out_.cut(now);
    on_ = false;
    on_at_ = when;
    hangs_until_ = blocked_until_ = 0;
    received_.clear();
    received_from_.clear();
    reading_ = {};
    sending_.clear();
    ++line_out_;
}

void BoardModel::hang(Micros now, Micros until) {
    reports_.state("board hangs");
    if (on_) hangs_until_ = std::max(now, until);
}

Micros BoardModel::next() const {
    if (!on_) return on_at_;
    Micros wish = last_pass_ + (busy_ || !received_.empty() ? pass_time_ : idle_pass_);
    if (!in_.empty() && in_.next() < wish) wish = std::max(last_pass_ + pass_time_, in_.next());
    if (hangs_until_ <= wish) return std::max(wish, blocked_until_);
    // The UART goes on receiving.
    return std::min(hangs_until_, in_.empty() ? kNever : std::max(in_.next(), last_pass_ + 1));
}

void BoardModel::run(Micros now) {
    if (!on_) {
        if (now < on_at_) return;
        on_ = true;
        while (!in_.empty() && in_.next() <= now)
            reports_.fault(Fault::kCut, in_.take());
        reports_.state("board on");
        send(now, firmware_.power_up(now));
        last_pass_ = now;
        return;
    }
    receive(now);
    last_pass_ = now;
    if (now < hangs_until_ || now < blocked_until_) return;
    const Micros pending = std::max<Micros>(0, out_.free_at() - now);
    const auto byte_time = std::max<Micros>(1, 10 * kSecond / firmware_.baud());
    const auto queued = static_cast<std::size_t>((pending + byte_time - 1) / byte_time);
    const std::size_t room = queued < kBuffer ? kBuffer - queued : 0;
    firmware_.run(now, received_, room, queued == 0, pass_);
    consume(now);
    busy_ = !pass_.read.empty() || !pass_.sent.empty();
    if (pass_.sent.size() > room)
        blocked_until_ = now + static_cast<Micros>(pass_.sent.size() - room) * byte_time;
    send(now, pass_.sent);
    if (pass_.rate_changed) {
        received_from_.clear();
        reading_ = {};
    }
}

void BoardModel::receive(Micros now) {
    while (!in_.empty() && in_.next() <= now)
        take(in_.take());
}

void BoardModel::take(WireByte byte) {
    if (byte.baud != firmware_.baud()) {
        reports_.fault(Fault::kNoise, byte);
        byte.value = dice_.chance(0.5) ? '\0' : static_cast<char>(dice_.below(256));
    }
    if (received_.size() >= kBuffer) {
        reports_.fault(Fault::kOverrun, byte);
        if (!silent_overrun_) received_.back() = '\0';
        return;
    }
    received_ += byte.value;
    received_from_.push_back(byte.line);
}

// What one pass read is a part of a line, or its end.
void BoardModel::consume(Micros now) {
    const std::string& read = pass_.read;
    for (std::size_t i = 0; i < read.size() && i < received_from_.size(); ++i)
        if (reading_.sources.empty() || reading_.sources.back() != received_from_[i])
            reading_.sources.push_back(received_from_[i]);
    received_from_.erase(
        received_from_.begin(),
        received_from_.begin() + static_cast<std::ptrdiff_t>(std::min(read.size(), received_from_.size())));
    reading_.text += pass_.text;
    // A request whose line end was lost ends where the next one begins: its effects come before the line's
    // end.
    reading_.effects.insert(reading_.effects.end(), pass_.effects.begin(), pass_.effects.end());
    if (reading_.text.empty()) return;
    if (!read.empty() && read != "\n") reading_.whole_at = now;
    reading_.reply += pass_.sent;
    // Without a line end: the board gave up a request that paused for too long.
    const bool ended = reading_.text.back() == '\n';
    if (!ended && pass_.sent.find('~') == std::string::npos) return;
    if (ended) reading_.text.pop_back();
    reading_.at = now;
    reports_.read(std::exchange(reading_, {}));
}

void BoardModel::send(Micros now, const std::string& bytes) {
    for (const char c : bytes) {
        out_.send(c, line_out_, firmware_.baud(), now);
        if (c != '\n') {
            sending_ += c;
            continue;
        }
        reports_.sent(line_out_++, std::exchange(sending_, {}));
    }
}

}  // namespace truth
