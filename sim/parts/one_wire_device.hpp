// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace asip::sim {

/// A DS18B20 thermometer, bit by bit, as its data sheet has it. It knows no time but that of its conversion.
class Ds18b20 {
  public:
    using Id = std::array<std::uint8_t, 8>;

    /// The id of a thermometer with this serial number: family, number, checksum.
    static Id id_of(std::uint64_t number);

    Ds18b20(Id id, double measured, bool parasite) : degrees(measured), id_(id), parasite_(parasite) {
        power_on();
    }

    /// What a thermometer is after its power came: it shows 85 degrees.
    void power_on();
    /// The bus was reset.
    void reset();
    /// It pulls the line down in the bit that begins now.
    bool sends_low() const;
    /// The level of the line in a bit, at `now` (microseconds).
    void take_bit(bool bit, double now);

    const Id& id() const { return id_; }

    double degrees;
    int to_damage = 0;  ///< so many of its scratchpads are sent with a wrong bit
    bool attached = true;

  private:
    enum class State {
        kCommand,
        kMatch,
        kSearch,
        kFunction,
        kWrite,
        kRead,
        kSendId,
        kConverting,
        kSendPower,
        kOut
    };

    void take_command(std::uint8_t command);
    void take_function(std::uint8_t function, double now);
    void finish_conversion(double now);
    void send(State state, std::size_t bits);
    bool id_bit(std::size_t bit) const { return (id_[bit / 8] >> bit % 8 & 1) != 0; }
    bool out_bit() const { return (out_[bit_ / 8] >> bit_ % 8 & 1) != 0; }

    Id id_;
    bool parasite_;
    std::array<std::uint8_t, 9> scratchpad_{}, out_{};
    State state_ = State::kOut;
    std::size_t bit_ = 0, bits_ = 0, step_ = 0;
    std::uint8_t byte_ = 0;
    double converted_at_ = -1;  ///< negative: it does not measure
};

/// x^8 + x^5 + x^4 + 1, the lowest bit first.
std::uint8_t one_wire_checksum(const std::uint8_t* bytes, std::size_t count);

}  // namespace asip::sim
