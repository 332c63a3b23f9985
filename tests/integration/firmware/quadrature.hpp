// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <chrono>
#include <vector>

#include "firmware_board.hpp"

namespace asip::firmware {

/// Turns wheels: drives the two pins of each encoder a quarter of a cycle apart, as the disks of real ones
/// do.
class Quadrature {
  public:
    struct Encoder {
        int first;
        int second;
        bool backwards = false;
    };

    Quadrature(FirmwareBoard& board, std::vector<Encoder> encoders)
        : board_(board), encoders_(std::move(encoders)) {
        put();
    }

    /// All wheels together, each cycle in `cycle` of simulated time.
    void turn(int cycles, std::chrono::nanoseconds cycle) {
        const auto begin = board_->now();
        for (int quarter = 1; quarter <= 4 * cycles; ++quarter) {
            const auto next = begin + cycle * quarter / 4;
            if (next > board_->now()) board_->run_for(next - board_->now());
            phase_ = (phase_ + 1) % 4;
            put();
        }
    }

  private:
    void put() {
        constexpr std::array<bool, 4> kLead = {false, true, true, false}, kLag = {false, false, true, true};
        const auto level = [](bool high) { return high ? sim::Level::kHigh : sim::Level::kLow; };
        for (const auto& encoder : encoders_) {
            board_->drive(encoder.first, level((encoder.backwards ? kLag : kLead)[phase_]));
            board_->drive(encoder.second, level((encoder.backwards ? kLead : kLag)[phase_]));
        }
    }

    FirmwareBoard& board_;
    std::vector<Encoder> encoders_;
    std::size_t phase_ = 2;  // both high, as the pull-ups hold them
};

}  // namespace asip::firmware
