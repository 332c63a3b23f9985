// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <functional>

#include "tests/truth/plan.hpp"

namespace truth {

/// A byte on its way, and which line of its sender it belongs to.
struct WireByte {
    char value = 0;
    std::uint32_t line = 0;
    unsigned baud = 0;   ///< at which it was sent
    Micros departs = 0;  ///< when its last bit leaves the sender's UART
    Micros arrives = 0;
};

enum class Fault : std::uint8_t { kLost, kTwice, kChanged, kInserted, kStalled, kNoise, kOverrun, kCut };
constexpr unsigned kFaults = 8;
const char* to_string(Fault fault);

/// One direction of a line that takes time for each byte, and does to the bytes what its plan says.
class Wire {
  public:
    /// `on_fault` hears of each byte that is not delivered as sent. `arrives` of the byte: when a delay or a
    /// cut that it begins is over.
    using OnFault = std::function<void(Fault, const WireByte&)>;
    Wire(const WirePlan& plan, Dice& dice, OnFault on_fault)
        : plan_(plan), dice_(dice), on_fault_(std::move(on_fault)) {}

    /// At `baud`, behind what was sent before.
    void send(char value, std::uint32_t line, unsigned baud, Micros now);
    /// When all that was sent has left.
    Micros free_at() const { return free_; }
    /// Bytes that were sent so far, lost ones too.
    std::uint64_t sent() const { return sent_; }

    /// When the next byte arrives; only if not empty().
    Micros next() const { return bytes_.front().arrives; }
    bool empty() const { return bytes_.empty(); }
    WireByte take();

    /// The sender stops: what has not left is lost.
    void cut(Micros now);
    /// The link ends: all is lost.
    void clear(Micros now);

  private:
    void befall(const ByteFault& fault, WireByte byte);
    void deliver(WireByte byte);
    Micros held(Micros time) const;

    const WirePlan& plan_;
    Dice& dice_;
    OnFault on_fault_;

    std::deque<WireByte> bytes_;
    Micros free_ = 0;
    Micros spaced_ = 0;    // when the last byte was through, before bytes were bunched
    unsigned losing_ = 0;  // bytes still to be lost in a row
    std::uint64_t sent_ = 0;
    Micros cut_until_ = 0;
};

}  // namespace truth
