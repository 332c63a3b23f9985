// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

struct avr_t;

namespace asip::sim {

class Alarm;

/// Every alarm of a board. A chip reset wipes simavr's timers: rearm() puts ours back.
class AlarmClock {
  public:
    explicit AlarmClock(avr_t& avr) : avr_(avr) {}
    avr_t& avr() { return avr_; }
    std::uint64_t cycle() const;
    void rearm();

  private:
    friend class Alarm;
    avr_t& avr_;
    std::vector<Alarm*> alarms_;
};

/// Calls back once, up to one instruction late. Uses one of simavr's 64 timers while armed.
class Alarm {
  public:
    Alarm(AlarmClock& clock, std::function<void()> callback);
    ~Alarm();
    Alarm(const Alarm&) = delete;
    Alarm& operator=(const Alarm&) = delete;

    /// Replaces an earlier time. A past cycle: as soon as possible.
    void at(std::uint64_t cycle);
    void cancel();
    AlarmClock& clock() { return clock_; }
    bool armed() const { return armed_; }
    /// The cycle it was armed for, since the callback may come late.
    std::uint64_t when() const { return when_; }

  private:
    friend class AlarmClock;
    static std::uint64_t fire(avr_t* avr, std::uint64_t when, void* param);
    void arm();

    AlarmClock& clock_;
    std::function<void()> callback_;
    std::uint64_t when_ = 0;
    bool armed_ = false;
};

}  // namespace asip::sim
