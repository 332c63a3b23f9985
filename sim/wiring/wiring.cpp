// SPDX-License-Identifier: Apache-2.0
#include "sim/wiring/wiring.hpp"

#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

namespace asip::sim {
namespace {

/// As addresses in the data space.
struct PwmChannel {
    int pin;
    std::uint16_t control;   ///< TCCRnA
    std::uint8_t connected;  ///< its COM bits of this channel: not 0 while the timer has the pin
    std::uint16_t compare;   ///< low byte of OCRnx; the Arduino core uses 8 bits everywhere
};

constexpr std::uint8_t kA = 0xc0;
constexpr std::uint8_t kB = 0x30;
constexpr std::uint8_t kC = 0x0c;

constexpr std::uint16_t kTimer0 = 0x44;  // TCCR0A; OCR0A 0x47, OCR0B 0x48
constexpr std::uint16_t kTimer1 = 0x80;  // TCCR1A; OCR1A 0x88, B 0x8a, C 0x8c
constexpr std::uint16_t kTimer2 = 0xb0;  // TCCR2A; OCR2A 0xb3, OCR2B 0xb4
constexpr std::uint16_t kTimer3 = 0x90;
constexpr std::uint16_t kTimer4 = 0xa0;
constexpr std::uint16_t kTimer5 = 0x120;

const std::vector<PwmChannel> kUno = {{6, kTimer0, kA, 0x47},  {5, kTimer0, kB, 0x48},
                                      {9, kTimer1, kA, 0x88},  {10, kTimer1, kB, 0x8a},
                                      {11, kTimer2, kA, 0xb3}, {3, kTimer2, kB, 0xb4}};

const std::vector<PwmChannel> kMega = {
    {13, kTimer0, kA, 0x47},  {4, kTimer0, kB, 0x48},   {11, kTimer1, kA, 0x88}, {12, kTimer1, kB, 0x8a},
    {10, kTimer2, kA, 0xb3},  {9, kTimer2, kB, 0xb4},   {5, kTimer3, kA, 0x98},  {2, kTimer3, kB, 0x9a},
    {3, kTimer3, kC, 0x9c},   {6, kTimer4, kA, 0xa8},   {7, kTimer4, kB, 0xaa},  {8, kTimer4, kC, 0xac},
    {46, kTimer5, kA, 0x128}, {45, kTimer5, kB, 0x12a}, {44, kTimer5, kC, 0x12c}};

// Pins 6 and 13 hang on the Leonardo's timer 4, which simavr does not have.
const std::vector<PwmChannel> kLeonardo = {{11, kTimer0, kA, 0x47},
                                           {3, kTimer0, kB, 0x48},
                                           {9, kTimer1, kA, 0x88},
                                           {10, kTimer1, kB, 0x8a},
                                           {5, kTimer3, kA, 0x98}};

/// Null: none.
const PwmChannel* find_pwm_channel(std::string_view board, int pin) {
    if (board == "1284p") return nullptr;  // its timers' registers are not described here
    const auto& channels = board == "mega" ? kMega : board == "leonardo" ? kLeonardo : kUno;
    for (const auto& channel : channels)
        if (channel.pin == pin) return &channel;
    return nullptr;
}

}  // namespace

Wiring::Wiring(avr_t& avr, const BoardKind& kind) : avr_(avr), kind_(kind), states_(kind.pins.size()) {
    for (auto* io = avr.io_port; io != nullptr; io = io->next) {
        if (std::strcmp(io->kind, "port") != 0) continue;
        Port port{this, reinterpret_cast<avr_ioport_t*>(io), 0, 0, 0, {}};
        for (std::size_t i = 0; i < kind.pins.size(); ++i)
            if (kind.pins[i].port == port.io->name)
                port.pins.emplace_back(kind.pins[i].bit, static_cast<int>(i));
        if (port.pins.empty()) continue;
        const auto registers = {port.io->r_port, port.io->r_ddr, port.io->r_pin};
        ports_.push_back(std::move(port));
        for (const auto address : registers)
            avr_irq_register_notify(avr_iomem_getirq(&avr, address, nullptr, AVR_IOMEM_IRQ_ALL), port_written,
                                    &ports_.back());
    }
}

Wiring::Port& Wiring::port_of(int number) const {
    const char name = kind_.pins[static_cast<std::size_t>(number)].port;
    for (auto& port : ports_)
        if (port.io->name == name) return port;
    std::abort();  // the board's pin table names a port that its chip does not have
}

std::uint8_t Wiring::mask_of(int number) const {
    return static_cast<std::uint8_t>(1 << kind_.pins[static_cast<std::size_t>(number)].bit);
}

PinState Wiring::pin(int number) const {
    if (!has_port(number)) return {};
    return read(port_of(number), mask_of(number));
}

PinState Wiring::read(const Port& port, std::uint8_t mask) const {
    const auto latch = avr_.data[port.io->r_port];
    if ((avr_.data[port.io->r_ddr] & mask) != 0) return {(latch & mask) != 0, true};
    // A pull-up is a 1 in the latch of an input
    const auto level = (port.driven & mask) != 0 ? port.levels : latch;
    return {(level & mask) != 0, false};
}

void Wiring::drive(int number, bool high) {
    if (!has_port(number)) return;
    auto& port = port_of(number);
    const auto mask = mask_of(number);
    port.driven |= mask;
    port.levels = static_cast<std::uint8_t>(high ? port.levels | mask : port.levels & ~mask);
    put(port, mask, high);
}

void Wiring::release(int number) {
    if (!has_port(number)) return;
    auto& port = port_of(number);
    const auto mask = mask_of(number);
    port.driven = static_cast<std::uint8_t>(port.driven & ~mask);
    port.levels = static_cast<std::uint8_t>(port.levels & ~mask);
    put(port, mask, (avr_.data[port.io->r_port] & mask) != 0);
}

bool Wiring::is_pulled_low(int number) const {
    if (!has_port(number)) return false;
    const auto& port = port_of(number);
    return (port.driven & ~port.levels & mask_of(number)) != 0;
}

void Wiring::put(Port& port, std::uint8_t mask, bool high) {
    avr_ioport_external_t external{};
    external.name = static_cast<unsigned char>(port.io->name) & 0x7f;
    external.mask = port.driven;
    external.value = port.levels;
    avr_ioctl(&avr_, AVR_IOCTL_IOPORT_SET_EXTERNAL(port.io->name), &external);
    if ((avr_.data[port.io->r_ddr] & mask) == 0) {
        int bit = 0;
        while ((mask >> bit) != 1)
            ++bit;
        avr_raise_irq(port.io->io.irq + bit, high ? 1 : 0);
    }
    update(port);
}

void Wiring::set_millivolts(int number, int millivolts) {
    const int channel = kind_.pins[static_cast<std::size_t>(number)].channel;
    auto* irq = avr_io_getirq(&avr_, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0 + channel);
    if (irq != nullptr) avr_raise_irq(irq, static_cast<std::uint32_t>(millivolts));
    drive(number, millivolts > 2500);
}

void Wiring::watch(int number, Callback callback) {
    watchers_.push_back({number, std::move(callback)});
}

std::optional<int> Wiring::pwm(int number) const {
    const auto* channel = find_pwm_channel(kind_.name, number);
    if (channel == nullptr || (avr_.data[channel->control] & channel->connected) == 0) return std::nullopt;
    return avr_.data[channel->compare];
}

void Wiring::watch_pwm(int number, std::function<void()> callback) {
    const auto* channel = find_pwm_channel(kind_.name, number);
    if (channel == nullptr) return;
    pwm_watchers_.push_back(std::move(callback));
    for (const auto address : {channel->control, channel->compare})
        avr_irq_register_notify(avr_iomem_getirq(&avr_, address, nullptr, AVR_IOMEM_IRQ_ALL), pwm_written,
                                &pwm_watchers_.back());
}

void Wiring::after_reset() {
    for (auto& port : ports_) {
        // The reset has cleared the PIN register, but simavr passes only changes on: without the lows a
        // pull-up that was on before the reset would never work again.
        for (int bit = 0; bit < 8; ++bit)
            avr_raise_irq(port.io->io.irq + bit, (port.driven & port.levels) >> bit & 1u);
        avr_.data[port.io->r_pin] = port.driven & port.levels;
        update(port);
    }
    for (auto& callback : pwm_watchers_)
        callback();
}

void Wiring::port_written(avr_irq_t*, std::uint32_t, void* param) {
    auto& port = *static_cast<Port*>(param);
    port.self->update(port);
}

void Wiring::pwm_written(avr_irq_t*, std::uint32_t, void* param) {
    (*static_cast<std::function<void()>*>(param))();
}

void Wiring::update(Port& port) {
    const std::uint32_t seen = avr_.data[port.io->r_port] | avr_.data[port.io->r_ddr] << 8 |
                               static_cast<std::uint32_t>(port.driven) << 16 |
                               static_cast<std::uint32_t>(port.levels) << 24;
    if (seen == port.seen) return;
    port.seen = seen;
    for (const auto& [bit, number] : port.pins) {
        const auto now = read(port, static_cast<std::uint8_t>(1 << bit));
        auto& before = states_[static_cast<std::size_t>(number)];
        if (now == before) continue;
        before = now;
        // A callback may drive other pins, but adds no watchers
        for (std::size_t i = 0; i < watchers_.size(); ++i)
            if (watchers_[i].number == number) watchers_[i].callback(now);
    }
}

}  // namespace asip::sim
