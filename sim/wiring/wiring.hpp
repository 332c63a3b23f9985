// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "sim/board_kind.hpp"
#include "sim/chip/alarm.hpp"
#include "sim/chip/simavr.hpp"

namespace asip::sim {

/// A pin at one moment.
struct PinState {
    bool high = false;
    bool output = false;
    bool operator==(const PinState&) const = default;
};

/// The board's pins seen from outside the chip: levels, what drives them, and what watches them. Pins are
/// Arduino pin numbers and have to exist. One without a port is low, whatever drives it.
class Wiring {
  public:
    using Callback = std::function<void(PinState)>;

    Wiring(avr_t& avr, const BoardKind& kind);

    PinState pin(int number) const;
    /// Drives the pin; an output of the chip wins over it. simavr lets a pull-up win over an outside low:
    /// here it does not.
    void drive(int number, bool high);
    void release(int number);
    /// Something outside drives the pin low.
    bool is_pulled_low(int number) const;
    void set_millivolts(int number, int millivolts);

    /// Called at each change of level or direction, in order of registration.
    void watch(int number, Callback callback);

    /// What analogWrite() puts out on the pin: 1..254 while its timer drives it, else nothing. Read from the
    /// timer's registers, since simavr shows no edges for two of the three timers.
    std::optional<int> pwm(int number) const;
    /// Called whenever the answer of pwm() may be another one.
    void watch_pwm(int number, std::function<void()> callback);

    /// After a reset of the chip: puts the levels that are driven from outside back on its pins.
    void after_reset();

  private:
    struct Port;
    struct Watcher {
        int number;
        Callback callback;
    };
    struct Port {
        Wiring* self;
        avr_ioport_t* io;
        std::uint8_t driven = 0;
        std::uint8_t levels = 0;
        std::uint32_t seen = 0;  // what update() last looked at: firmware polls its ports all the time
        std::vector<std::pair<int, int>> pins;  // bit, Arduino number
    };

    static void port_written(avr_irq_t* irq, std::uint32_t value, void* param);
    static void pwm_written(avr_irq_t* irq, std::uint32_t value, void* param);
    bool has_port(int number) const { return kind_.pins[static_cast<std::size_t>(number)].port != '-'; }
    Port& port_of(int number) const;
    std::uint8_t mask_of(int number) const;
    PinState read(const Port& port, std::uint8_t mask) const;
    void put(Port& port, std::uint8_t mask, bool high);
    void update(Port& port);

    avr_t& avr_;
    const BoardKind& kind_;
    mutable std::deque<Port> ports_;  // their addresses are simavr's callback parameters
    std::vector<PinState> states_;
    std::vector<Watcher> watchers_;
    std::deque<std::function<void()>> pwm_watchers_;
};

}  // namespace asip::sim
