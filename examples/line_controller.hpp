// SPDX-License-Identifier: Apache-2.0
// What a line follower decides: three reflectance values in, the power of two motors out. No clock, no board.
// As on the published robot, IR 0 is the right sensor, motor 0 the left one, and motor 1 is mounted the other
// way round.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

struct LineGains {
    double power = 50;  // of both motors while the line is in the middle, percent
    double kp = 0.015;
    double ki = 0;    // of the sum over all measurements
    double kd = 0;    // of the change since the last measurement
    int cutoff = 50;  // what is below it is floor
};

class LineController {
  public:
    explicit LineController(const LineGains& gains) : gains_(gains) {}

    // -2000 (under the left sensor) to 2000 (under the right one); the last one where no sensor sees the
    // line.
    double error(std::array<int, 3> sensors) {
        for (int& value : sensors)
            if (value < gains_.cutoff) value = 0;
        const auto [right, middle, left] = sensors;
        const int sum = left + middle + right;
        if (sum > 0) error_ = (2000.0 * middle + 4000.0 * right) / sum - 2000;
        return error_;
    }

    // -255 to 255 for the left and the right motor. The right one is mounted the other way round.
    std::array<int, 2> drive(const std::array<int, 3>& sensors) {
        const double before = error_;
        const double now = error(sensors);
        sum_ += now;
        const double turn = gains_.kp * now + gains_.ki * sum_ + gains_.kd * (now - before);
        return {motor(gains_.power + turn), -motor(gains_.power - turn)};
    }

  private:
    static int motor(double percent) {
        return static_cast<int>(std::lround(2.55 * std::clamp(percent, -100.0, 100.0)));
    }

    LineGains gains_;
    double error_ = 0;
    double sum_ = 0;
};
