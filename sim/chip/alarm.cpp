// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/alarm.hpp"

#include <algorithm>

#include "sim/chip/simavr.hpp"

namespace asip::sim {

std::uint64_t AlarmClock::cycle() const {
    return avr_.cycle;
}

void AlarmClock::rearm() {
    for (auto* alarm : alarms_)
        if (alarm->armed_) alarm->arm();
}

Alarm::Alarm(AlarmClock& clock, std::function<void()> callback)
    : clock_(clock), callback_(std::move(callback)) {
    clock_.alarms_.push_back(this);
}

Alarm::~Alarm() {
    cancel();
    std::erase(clock_.alarms_, this);
}

void Alarm::at(std::uint64_t cycle) {
    when_ = cycle;
    armed_ = true;
    arm();
}

void Alarm::arm() {
    const auto now = clock_.avr_.cycle;
    avr_cycle_timer_register(&clock_.avr_, when_ > now ? when_ - now : 1, fire, this);
}

void Alarm::cancel() {
    if (armed_) avr_cycle_timer_cancel(&clock_.avr_, fire, this);
    armed_ = false;
}

std::uint64_t Alarm::fire(avr_t*, std::uint64_t, void* param) {
    auto& alarm = *static_cast<Alarm*>(param);
    alarm.armed_ = false;
    alarm.callback_();
    return 0;
}

}  // namespace asip::sim
