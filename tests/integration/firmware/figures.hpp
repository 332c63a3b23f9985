// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace asip::firmware {

/// One of the figures that the firmware is held to: on an Uno with the I/O service and all four link
/// extensions.
struct Figure {
    std::string name;
    std::string unit;
    double measured;
    double must;  ///< 0: nothing is demanded
    double aim;
    bool more_is_better = false;
    int decimals = 0;

    bool met(double limit) const {
        return limit == 0 || (more_is_better ? measured >= limit : measured <= limit);
    }
};

/// Measures them all: bytes of avr-size and simulated cycles, the same on every run. Takes some seconds.
std::vector<Figure> measure_figures();

}  // namespace asip::firmware
