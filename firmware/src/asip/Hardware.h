// SPDX-License-Identifier: Apache-2.0
// All that the core asks of the chip. On a board it is the Arduino core (HardwareAvr.h, HardwareGeneric.h for
// chips that are not AVR), for the tests on the host a fake of the same shape
// (tests/unit/firmware/FakeHardware.h).
#pragma once

#if defined(__AVR__)
#include "HardwareAvr.h"
#elif defined(ARDUINO)
#include "HardwareGeneric.h"
#else
#include "FakeHardware.h"
#endif
