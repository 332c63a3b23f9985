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

struct PinState {
    bool high = false;
    bool output = false;
    bool operator==(const PinState&) const = default;
};

/// The pins from outside the chip: levels, what drives them, what watches them, by Arduino numbers. A pin
/// without a port is low.
class Wiring {
  public:
    using Callback = std::function<void(PinState)>;

    Wiring(avr_t& avr, const BoardKind& kind);

    PinState pin(int number) const;
    /// An output of the chip wins. simavr lets a pull-up win over an outside low: here it does not.
    void drive(int number, bool high);
    void release(int number);
    bool is_pulled_low(int number) const;
    void set_millivolts(int number, int millivolts);

    /// At each change of level or direction, in order of registration.
    void watch(int number, Callback callback);

    /// 1..254 while the pin's timer drives it, else nothing. From the registers, since simavr shows no edges
    /// for two of the three timers.
    std::optional<int> pwm(int number) const;
    /// pwm() may have changed.
    void watch_pwm(int number, std::function<void()> callback);

    /// Drives the outside levels again.
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
