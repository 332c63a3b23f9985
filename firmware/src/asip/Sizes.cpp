// SPDX-License-Identifier: Apache-2.0
// RAM on AVR, where each byte is deliberate: a change here is a decision, not an accident.
#ifdef __AVR__

#include "../AsipDistance.h"
#include "../AsipServos.h"

namespace asip {

static_assert(sizeof(Service) == 10, "what every service costs");
static_assert(sizeof(Request) == 4, "lives on the stack of every request");
static_assert(sizeof(Distance) == 10 + 3 * Distance::kMaxSensors + 1, "a pin and a value for each sensor");
static_assert(sizeof(Servos) == 10 + Servos::kMaxServos + 2, "a pin for each servo");
#if defined(__AVR_ATmega328P__)
static_assert(sizeof(IoService) == 10 + hw::kPins + 2 * 3 + 1, "a byte for each pin, two for each port");
static_assert(sizeof(Board) == sizeof(IoService) + kMaxRequestLength + 1 + 15, "the rest of the board");
#endif

}  // namespace asip

#endif
