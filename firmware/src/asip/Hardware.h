// All that the core asks of the chip. On a board it is the Arduino core (HardwareAvr.h), for the tests on
// the host a fake of the same shape (tests/unit/firmware/FakeHardware.h).
#pragma once

#ifdef ARDUINO
#include "HardwareAvr.h"
#else
#include "FakeHardware.h"
#endif
