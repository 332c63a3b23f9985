// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "firmware_board.hpp"

namespace asip::firmware {

/// Widths and distances of the pulses on a pin from now on, in microseconds.
struct Pulses {
    explicit Pulses(FirmwareBoard& board, int pin) {
        const double cycles_per_us = board->config().frequency / 1e6;
        board->on_pin(pin, [this, &board, cycles_per_us](sim::Level level) {
            const double now = static_cast<double>(board->cycles()) / cycles_per_us;
            if (level == sim::Level::kHigh) {
                if (rose != 0) periods.push_back(now - rose);
                rose = now;
            } else if (rose != 0) {
                widths.push_back(now - rose);
            }
        });
    }
    double rose = 0;
    std::vector<double> widths, periods;
};

}  // namespace asip::firmware
