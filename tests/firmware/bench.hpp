// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "Asip.h"
#include "tests/firmware/judge.hpp"

namespace wire {

/// The firmware's board on this machine, with services `C` and `E`, and a judge that reads what it reads.
/// There is one board, because the firmware's is a global variable.
class Bench {
  public:
    /// A board that just got its power. Without inputs, a pass of its loop is shorter.
    explicit Bench(bool with_inputs);

    /// Gives the board a byte, or a second without any: nullptr, or what is wrong with what it did.
    const char* byte(std::uint8_t byte);
    const char* second_of_silence();
    /// The same for each of several bytes.
    const char* bytes(std::string_view bytes);

    const Judge& judge() const { return judge_; }
    /// Requests that were executed by a service, or as a write of a pin.
    std::uint64_t executed() const { return executed_; }

    /// All that decides what comes next. Bytes of the board's line that hold nothing any more are those of
    /// arguments, so that a parser that reads beyond its line finds some; equal states are equal bytewise.
    struct State {
        alignas(asip::Board) std::array<std::byte, sizeof(asip::Board)> board;
        alignas(asip::Out) std::array<std::byte, sizeof(asip::Out)> out;
        Judge judge;
        std::string_view as_bytes() const { return {reinterpret_cast<const char*>(this), sizeof *this}; }
    };
    void save(State& state) const;
    void put_back(const State& state);

  private:
    bool settle();
    void pass();

    Judge judge_;
    std::uint64_t executed_ = 0;
};

}  // namespace wire
