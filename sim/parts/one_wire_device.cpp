// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/one_wire_device.hpp"

#include <algorithm>
#include <cmath>

namespace asip::sim {
namespace {

constexpr std::uint8_t kFamily = 0x28;
// Commands of the data sheet of the DS18B20.
constexpr std::uint8_t kReadId = 0x33, kMatchId = 0x55, kSkipId = 0xcc, kSearchId = 0xf0;
constexpr std::uint8_t kConvert = 0x44, kReadScratchpad = 0xbe, kWriteScratchpad = 0x4e, kReadPower = 0xb4;
constexpr std::array<double, 4> kConversionUs{93750, 187500, 375000, 750000};

}  // namespace

std::uint8_t one_wire_checksum(const std::uint8_t* bytes, std::size_t count) {
    unsigned sum = 0;
    for (std::size_t i = 0; i < 8 * count; ++i) {
        const bool mix = ((sum ^ static_cast<unsigned>(bytes[i / 8] >> i % 8)) & 1) != 0;
        sum = (sum >> 1) ^ (mix ? 0x8cu : 0u);
    }
    return static_cast<std::uint8_t>(sum);
}

Ds18b20::Id Ds18b20::id_of(std::uint64_t number) {
    Id id{kFamily};
    for (std::size_t i = 1; i < 7; ++i)
        id[i] = static_cast<std::uint8_t>(number >> 8 * (i - 1));
    id[7] = one_wire_checksum(id.data(), 7);
    return id;
}

void Ds18b20::power_on() {
    scratchpad_ = {0x50, 0x05, 0x4b, 0x46, 0x7f, 0xff, 0x0c, 0x10};
    state_ = State::kOut;
    converted_at_ = -1;
}

void Ds18b20::reset() {
    state_ = State::kCommand;
    bit_ = step_ = 0;
    byte_ = 0;
}

bool Ds18b20::sends_low() const {
    if (!attached) return false;
    switch (state_) {
        case State::kSearch:
            return step_ == 0 ? !id_bit(bit_) : step_ == 1 && id_bit(bit_);
        case State::kRead:
        case State::kSendId:
            return !out_bit();
        case State::kConverting:
            return true;
        case State::kSendPower:
            return parasite_;
        default:
            return false;
    }
}

void Ds18b20::take_bit(bool bit, double now) {
    if (!attached) return;
    finish_conversion(now);
    switch (state_) {
        case State::kSearch:
            if (step_ == 2 && bit != id_bit(bit_)) {
                state_ = State::kOut;
                return;
            }
            step_ = (step_ + 1) % 3;
            if (step_ == 0 && ++bit_ == 64) state_ = State::kFunction;
            if (state_ == State::kFunction) bit_ = 0;
            return;
        case State::kMatch:
            if (bit != id_bit(bit_)) state_ = State::kOut;
            if (++bit_ == 64 && state_ == State::kMatch) {
                state_ = State::kFunction;
                bit_ = 0;
            }
            return;
        case State::kRead:
        case State::kSendId:
            if (++bit_ == bits_) {
                state_ = state_ == State::kSendId ? State::kFunction : State::kOut;
                bit_ = 0;
            }
            return;
        case State::kCommand:
        case State::kFunction:
        case State::kWrite:
            break;
        default:
            return;
    }
    byte_ = static_cast<std::uint8_t>(byte_ >> 1 | (bit ? 0x80 : 0));
    if (++bit_ % 8 != 0) return;
    if (state_ == State::kWrite) {
        scratchpad_[1 + bit_ / 8] = bit_ == 24 ? static_cast<std::uint8_t>((byte_ & 0x60) | 0x1f) : byte_;
        if (bit_ == 24) state_ = State::kOut;
        return;
    }
    bit_ = 0;
    if (state_ == State::kCommand)
        take_command(byte_);
    else
        take_function(byte_, now);
}

void Ds18b20::take_command(std::uint8_t command) {
    step_ = 0;
    state_ = command == kMatchId    ? State::kMatch
             : command == kSearchId ? State::kSearch
             : command == kSkipId   ? State::kFunction
                                    : State::kOut;
    if (command != kReadId) return;
    std::copy(id_.begin(), id_.end(), out_.begin());
    send(State::kSendId, 64);
}

void Ds18b20::take_function(std::uint8_t function, double now) {
    state_ = State::kOut;
    if (function == kWriteScratchpad) state_ = State::kWrite;
    if (function == kReadPower) state_ = State::kSendPower;
    if (function == kConvert) {
        // One that is powered by its line needs it held high by more than a resistor: it measures nothing.
        if (parasite_) return;
        converted_at_ = now + kConversionUs[scratchpad_[4] >> 5 & 3];
        state_ = State::kConverting;
    }
    if (function == kReadScratchpad) {
        scratchpad_[8] = one_wire_checksum(scratchpad_.data(), 8);
        out_ = scratchpad_;
        if (to_damage > 0) {
            --to_damage;
            out_[0] ^= 4;
        }
        send(State::kRead, 72);
    }
}

void Ds18b20::finish_conversion(double now) {
    if (converted_at_ < 0 || now < converted_at_) return;
    converted_at_ = -1;
    if (state_ == State::kConverting) state_ = State::kOut;
    const int unused = 3 - (scratchpad_[4] >> 5 & 3);
    const auto raw = static_cast<unsigned>(std::lround(degrees * 16)) & (0xffffu << unused);
    scratchpad_[0] = static_cast<std::uint8_t>(raw);
    scratchpad_[1] = static_cast<std::uint8_t>(raw >> 8);
}

void Ds18b20::send(State state, std::size_t bits) {
    state_ = state;
    bit_ = 0;
    bits_ = bits;
}

}  // namespace asip::sim
