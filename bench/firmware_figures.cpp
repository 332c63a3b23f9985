// SPDX-License-Identifier: Apache-2.0
// Prints the figures that the firmware is held to. Status 1 if one that must be met is not.
#include <cstdio>
#include <exception>

#include "tests/integration/firmware/figures.hpp"

int main() try {
    bool good = true;
    std::printf("%-36s %10s %8s %8s\n", "Uno; I/O service, all extensions", "measured", "must", "aim");
    for (const auto& figure : asip::firmware::measure_figures()) {
        const auto column = [&](double value, int width) {
            if (value == 0) {
                std::printf(" %*s", width, "-");
            } else {
                std::printf(" %*.*f", width, figure.decimals == 4 && width < 10 ? 2 : figure.decimals, value);
            }
        };
        std::printf("%-36s", figure.name.c_str());
        column(figure.measured, 10);
        column(figure.must, 8);
        column(figure.aim, 8);
        std::printf(" %-3s%s\n", figure.unit.c_str(),
                    !figure.met(figure.must)  ? " NOT MET"
                    : !figure.met(figure.aim) ? " met, short of the aim"
                                              : "");
        good = good && figure.met(figure.must);
    }
    return good ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_firmware_figures: %s\n", error.what());
    return 1;
}
