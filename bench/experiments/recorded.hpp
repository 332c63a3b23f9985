// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::experiments {

/// What others need for the same, as it was recorded when the goals of this project were set. A value of 0
/// was not recorded.
struct Peer {
    const char* name;
    int ram_bytes, flash_bytes;
    double round_trip_ms;      ///< pin 13 to pin 2 at the wire's own speed, 57600 baud
    double square_wave_hertz;  ///< followed without losing an edge, 57600 baud
};

inline constexpr Peer kPeers[] = {
    {"ASIP 0.4", 850, 11'864, 3.12, 324},
    {"StandardFirmata", 1'057, 13'182, 1.07, 991},
};
inline constexpr Peer kEmptySketch{"sketch that only opens Serial", 186, 1'490, 0, 0};

inline constexpr const char* kWhereFrom =
    "ASIP 0.4 and StandardFirmata: recorded in November 2026. Their sketches with the I/O service only, "
    "built with "
    "this compiler and Arduino core, in the simulator, in simulated time and without a program in between.";
inline constexpr const char* kNotRecorded =
    "The papers' own figures are not recorded in this project, so they are not shown beside these.";

}  // namespace asip::experiments
