// SPDX-License-Identifier: Apache-2.0
// Prints the figures that the firmware is held to. Status 1 if one that must be met is not.
#include <cstdio>
#include <exception>

#include "tests/integration/firmware/figures.hpp"

int main() try {
    bool good = true;
    std::printf("Uno; I/O service, all extensions\n");
    for (const auto& figure : asip::firmware::measure_figures()) {
        const int decimals = figure.decimals;
        std::printf("%-40s %10.*f %-5s", figure.name.c_str(), decimals, figure.measured, figure.unit.c_str());
        if (figure.must != 0) std::printf(" must %8.*f", decimals, figure.must);
        if (figure.aim != 0) std::printf("  aim %8.*f", decimals, figure.aim);
        std::printf("  %s\n", figure.met(figure.must) ? "ok" : "MISSED");
        good = good && figure.met(figure.must);
    }
    return good ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_firmware_figures: %s\n", error.what());
    return 1;
}
