// SPDX-License-Identifier: Apache-2.0
// Carries the line with the Arduino core's own `Serial`, or with another port of its kind:
//
//   #define ASIP_SERIAL Serial1
//   #include <AsipSerial.h>
//
// On chips that are not AVR, define ASIP_TX_PIN and ASIP_RX_PIN, too, if the port's pins are not 0 and 1 (an
// ESP8266 or ESP32 knows those of Serial).
//
// Its availableForWrite() must give 42 or more when nothing waits to be sent: no request is executed before.
//
// Include it in the sketch, once, instead of <AsipFastSerial.h>. Unlike that, it does not notice when bytes
// were lost because more than 63 came while the board was busy: a peer that floods a board should turn the
// checksum on.
#pragma once

#include <Arduino.h>

#include "asip/Config.h"
#include "asip/Line.h"
#include "asip/Rates.h"

#ifndef ASIP_SERIAL
#define ASIP_SERIAL Serial
#endif

namespace asip {
namespace coreCheck {

template <typename Port>
auto isPort(Port* port) -> decltype(port->begin(57600UL), port->read() + port->availableForWrite(),
                                    port->write(static_cast<uint8_t>(0)), port->flush(), true);
struct NoPort {
    char twoBytes[2];
};
NoPort isPort(...);
static_assert(
    sizeof(isPort(&ASIP_SERIAL)) == sizeof(bool),
    "Asip needs a serial port with begin(baud), read(), write(byte), availableForWrite() and flush(): "
    "ASIP_SERIAL lacks one of them");

}  // namespace coreCheck

namespace line {

void begin() {
    ASIP_SERIAL.begin(kDefaultRate * 100UL);
}
int16_t read() {
    return ASIP_SERIAL.read();
}
uint8_t room() {
#ifdef __AVR__
    return static_cast<uint8_t>(ASIP_SERIAL.availableForWrite());
#else
    const int room = ASIP_SERIAL.availableForWrite();
    return static_cast<uint8_t>(room > 255 ? 255 : room);
#endif
}
void write(uint8_t byte) {
    ASIP_SERIAL.write(byte);
}
bool idle() {
    return true;
}  // setRate() waits

bool canMakeRate(uint16_t hundreds) {
    const bool known = hundreds == 1152 || hundreds == 2500 || hundreds == 5000 || hundreds == 10000;
#if defined(__AVR__) && !defined(USBCON)
    return hundreds == kDefaultRate ||
           (known && hundreds * 100UL <= F_CPU / 16 && canDivideTo(F_CPU / 8, hundreds * 100UL));
#else
    return hundreds == kDefaultRate || known;
#endif
}

ASIP_RATE_UNLESS_TOLD bool isRate(uint16_t hundreds) {
    return canMakeRate(hundreds);
}

void setRate(uint16_t hundreds) {
    ASIP_SERIAL.flush();
    ASIP_SERIAL.begin(hundreds * 100UL);
    while (ASIP_SERIAL.read() >= 0) {
    }
}

bool usesPin(uint8_t pin) {
#if defined(USBCON)
    (void)pin;
    return false;
#elif defined(__AVR_ATmega1284P__) || defined(__AVR_ATmega1284__) || defined(__AVR_ATmega644P__) || \
    defined(__AVR_ATmega644__)
    return digitalPinToPort(pin) == 4 /* D */ && digitalPinToBitMask(pin) <= 2;
#elif defined(ASIP_TX_PIN) && defined(ASIP_RX_PIN)
    return pin == ASIP_TX_PIN || pin == ASIP_RX_PIN;
#elif defined(ESP8266) || defined(ESP32)
    return pin == TX || pin == RX;
#else
    return pin < 2;
#endif
}

}  // namespace line
}  // namespace asip
