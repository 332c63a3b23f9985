// SPDX-License-Identifier: Apache-2.0
// Calls functions whenever the level of one of their pins may have changed, from an interrupt: by the
// pin-change interrupts of an AVR, and on a Mega or Leonardo by the external interrupts of the pins that have
// no such. On other chips as the core's attachInterrupt() can.
#pragma once

#include <stdint.h>

// Functions that interrupts call are in RAM, where the flash cannot always be read.
#if defined(ESP8266) || defined(ESP32)
#include <Arduino.h>
#define ASIP_FROM_INTERRUPT IRAM_ATTR
#else
#define ASIP_FROM_INTERRUPT
#endif

namespace asip {

class PinInterrupts {
  public:
    typedef void (*Handler)();

    // The handler that is called. Each is called for the pins of the other too.
    enum Slot : uint8_t { kEcho, kEncoders };

    // From now on `handler` is called for changes of `pin`. False if the pin has no interrupt.
    static bool enable(uint8_t pin, Slot slot, Handler handler);
    static void disable(uint8_t pin);

    // The same for DhtPulses::onPinChange(), which is called ahead of the others, as its pulses are timed
    // closely. Where nothing calls this it costs nothing.
    static bool enableDht(uint8_t pin);
};

}  // namespace asip
