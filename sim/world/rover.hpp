// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "sim/world/geometry.hpp"

namespace asip::sim::world {

/// The measures of a rover. Defaults are the MIRTO robot's where they are known: its wheels have 60 mm, turn
/// 120 times a minute at full power and carry encoders. The others are plausible for a robot of its size.
struct RoverSpec {
    double wheel_mm = 60;        ///< diameter
    double rpm = 120;            ///< at full power
    double encoder_cycles = 32;  ///< of one encoder pin in a turn of its wheel; assumed
    double base_mm = 120;        ///< between the wheels' middles; assumed
    double radius_mm = 90;       ///< of its round body; assumed

    /// Time constant of the speed after a change of power; assumed.
    double lag_ms = 60;
    double dead_band = 0;  ///< least power that moves a wheel, 0 to 1; 0: none
    double slip = 0;       ///< share of a wheel's way that does not move the rover

    /// Three reflectance sensors in a row across; as a QTR-3A has them. Assumed, with their place and spot.
    double sensor_pitch_mm = 9.525;
    double sensor_ahead_mm = 60;  ///< of the axle
    double spot_mm = 3;           ///< radius of what a sensor sees
    double white = 25;            ///< value on the floor, 0 to 1023
    double black = 900;           ///< value on the line
    double noise = 0;             ///< standard deviation of the values
};

/// What a wheel did: how far it has turned since the start (radians, forwards positive) and how fast it turns
/// (radians a second).
struct Wheel {
    double turned = 0;
    double speed = 0;
};

/// Two driven wheels under a round body. Pure: time goes in, a pose comes out.
class Rover {
  public:
    Rover(const RoverSpec& spec, const Pose& pose) : spec_(spec), pose_(pose) {}

    /// Lets `seconds` pass with this power at the left and right wheel, -1 to 1, forwards positive.
    void step(double left, double right, double seconds);

    const Pose& pose() const { return pose_; }
    /// Puts it down elsewhere; the wheels stand.
    void place(const Pose& pose);
    /// Something holds it: the wheels turn on, it does not move.
    void hold_at(const Pose& pose) { pose_ = pose; }

    enum Side { kLeft, kRight };
    const Wheel& wheel(Side side) const { return wheels_[side]; }
    /// Millimetres a second at full power.
    double top_speed() const;

  private:
    double advance(Wheel& wheel, double power, double seconds) const;

    RoverSpec spec_;
    Pose pose_;
    std::array<Wheel, 2> wheels_;
};

}  // namespace asip::sim::world
