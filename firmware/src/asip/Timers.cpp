// SPDX-License-Identifier: Apache-2.0
#include "Hardware.h"

#ifdef __AVR__

namespace asip {
namespace hw {

uint8_t takenTimers;
bool busPinsTaken = false;  // written out: only so does the compiler take it for the constant that it may be

}  // namespace hw
}  // namespace asip

#elif defined(ARDUINO)

namespace asip {
namespace hw {

uint8_t busPins[2] = {kNoPin, kNoPin};

}  // namespace hw
}  // namespace asip

#endif
