// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
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
    /// A symbol of tests/support/explorer.hpp. Board and judge then go on from one digest, unless it is zero:
    /// it decides nothing but the digest after the next request, so that states that differ in it are equal.
    const char* step(int symbol);
    /// Whether the board's digest of a byte is the judge's, whatever the digest before.
    static bool digests_agree();
    /// CR and silence end a request as LF does.
    bool ends_at(int symbol) const;
    bool line_is_open() const { return judge_.line_is_open(); }

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
        bool operator==(const State& other) const { return as_bytes() == other.as_bytes(); }
        std::size_t hash() const { return std::hash<std::string_view>()(as_bytes()); }
    };
    void save(State& state) const;
    void put_back(const State& state);

  private:
    const char* try_symbol(int symbol);
    bool settle();
    void pass();

    Judge judge_;
    std::uint64_t executed_ = 0;
};

}  // namespace wire
