// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/wire.hpp"

#include <algorithm>

namespace truth {

namespace {

Micros byte_time(unsigned baud) {
    return std::max<Micros>(1, 10 * kSecond / baud);
}

}  // namespace

const char* to_string(Fault fault) {
    constexpr const char* kNames[] = {"lost",    "twice", "changed", "inserted",
                                      "stalled", "noise", "overrun", "cut"};
    return kNames[static_cast<int>(fault)];
}

Micros Wire::held(Micros time) const {
    for (const Span& stall : plan_.stalls)
        if (stall.covers(time)) time = stall.until;
    return time;
}

void Wire::send(char value, std::uint32_t line, unsigned baud, Micros now) {
    free_ = std::max(now, free_) + byte_time(baud);
    WireByte byte{value, line, baud, free_, 0};
    const std::uint64_t number = sent_++;
    for (const ByteFault& fault : plan_.faults)
        if (fault.byte == number) return befall(fault, byte);
    if (free_ < cut_until_) return on_fault_(Fault::kLost, byte);
    if (!plan_.damaged.covers(free_) || !plan_.damages()) return deliver(byte);
    if (losing_ == 0 && dice_.chance(plan_.lose_several))
        losing_ = static_cast<unsigned>(dice_.between(2, 30));
    if (losing_ > 0 || dice_.chance(plan_.lose)) {
        if (losing_ > 0) --losing_;
        return on_fault_(Fault::kLost, byte);
    }
    if (dice_.chance(plan_.insert)) {
        WireByte noise = byte;
        noise.value = static_cast<char>(dice_.below(256));
        on_fault_(Fault::kInserted, noise);
        deliver(noise);
    }
    if (dice_.chance(plan_.change)) {
        const char changed =
            static_cast<char>(dice_.chance(0.5) ? value ^ (1 << dice_.below(8)) : dice_.between(0x20, 0x7e));
        if (changed != value) {
            byte.value = changed;
            on_fault_(Fault::kChanged, byte);
        }
    }
    deliver(byte);
    if (dice_.chance(plan_.twice)) {
        on_fault_(Fault::kTwice, byte);
        deliver(byte);
    }
}

void Wire::befall(const ByteFault& fault, WireByte byte) {
    switch (fault.kind) {
        case ByteFault::Kind::kCut:
            byte.arrives = cut_until_ = std::max(cut_until_, free_ + fault.lasts);
            [[fallthrough]];
        case ByteFault::Kind::kLost:
            return on_fault_(Fault::kLost, byte);
        default:
            break;
    }
    if (free_ < cut_until_) return on_fault_(Fault::kLost, byte);
    if (fault.kind == ByteFault::Kind::kDelayed) {
        byte.arrives = spaced_ = std::max(spaced_, byte.departs + plan_.latency + fault.lasts);
        on_fault_(Fault::kStalled, byte);
    } else {
        if (fault.kind == ByteFault::Kind::kChanged)
            byte.value = static_cast<char>(byte.value ^ (1 << fault.bit));
        on_fault_(fault.kind == ByteFault::Kind::kChanged ? Fault::kChanged : Fault::kTwice, byte);
    }
    deliver(byte);
    if (fault.kind == ByteFault::Kind::kTwice) deliver(byte);
}

void Wire::deliver(WireByte byte) {
    const Micros due = byte.departs + plan_.latency;
    const Micros arrival = std::max(held(due), spaced_ + byte_time(byte.baud));
    if (held(due) > due) on_fault_(Fault::kStalled, byte);
    spaced_ = arrival;
    byte.arrives = plan_.bunch == 1 ? arrival : (arrival + plan_.bunch - 1) / plan_.bunch * plan_.bunch;
    bytes_.push_back(byte);
}

WireByte Wire::take() {
    const WireByte byte = bytes_.front();
    bytes_.pop_front();
    return byte;
}

void Wire::cut(Micros now) {
    while (!bytes_.empty() && bytes_.back().departs > now) {
        on_fault_(Fault::kCut, bytes_.back());
        bytes_.pop_back();
    }
    free_ = std::min(free_, now);
}

void Wire::clear(Micros now) {
    for (const WireByte& byte : bytes_)
        on_fault_(Fault::kCut, byte);
    bytes_.clear();
    free_ = spaced_ = now;
}

}  // namespace truth
