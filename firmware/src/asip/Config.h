// SPDX-License-Identifier: Apache-2.0
// What is decided when the library is compiled.
#pragma once

#include <stdint.h>

// 1: a board with the link extensions (echo, identity, line rate, checksum). 0: a plain ASIP 0.4 board.
#ifndef ASIP_EXTENSIONS
#define ASIP_EXTENSIONS 1
#endif

// Raised with each release whose sketches do something else: "2" is 0.2, "103" is 1.3. `#,X` says it, and
// hosts know by it which boards are out of date.
#define ASIP_FIRMWARE_VERSION "2"

namespace asip {

constexpr bool kExtensions = ASIP_EXTENSIONS;

// Characters of the longest request, without its line end, where no service brings a longer buffer
// (Board::useLongLines). One RAM byte each.
constexpr uint8_t kMaxRequestLength = 63;

// What a longer buffer holds beside a request: *HH and an end.
constexpr uint8_t kBehindRequest = 4;

// Line rates are counted in hundreds of baud, which fit 16 bits: 100 bytes less flash. The rate after a
// reset, and the one a board returns to:
constexpr uint16_t kDefaultRate = 576;

// After a silence of this length a request is complete without its line end, as on 0.4 boards; only while no
// extension is in use on the link.
constexpr uint16_t kSilenceMs = 1000;

// The same for one of which bytes were lost: what comes then is the beginning of another.
constexpr uint16_t kSpoiledMs = 20;

// How long a board stays at a new line rate without hearing a fence there.
constexpr uint16_t kRateTrialMs = 500;

constexpr uint8_t kMaxNameLength = 32;
constexpr uint8_t kMaxTokenLength = 8;

// Period of analog events after a reset.
constexpr uint16_t kAnalogPeriodMs = 50;

}  // namespace asip
