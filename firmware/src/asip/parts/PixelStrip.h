// SPDX-License-Identifier: Apache-2.0
// A strip of WS2812 pixels on one pin, which shows what it is told in the loop: 33 microseconds a pixel, in
// which the loop stands but interrupts do not, so that no byte of the line is lost at 1,000,000 baud. On an
// AVR at 16 or 8 MHz.
//
//   asip::PixelStripOf<18> strip(6);      // 18 pixels on pin 6: three bytes of RAM each
#pragma once

#include <stdint.h>

namespace asip {

class Service;

class PixelStrip {
  public:
    // Takes the pin for `service` and makes every pixel dark. Call when the service begins.
    void begin(const Service& service);

    // False if the pin is in use elsewhere: nothing is shown.
    bool isAvailable(const Service& service) const;

    uint8_t count() const { return count_; }

    // `pixel` has to be below count().
    void set(uint8_t pixel, uint8_t red, uint8_t green, uint8_t blue);

    // From the next show on; 255 at the beginning.
    void setBrightness(uint8_t brightness) { brightness_ = brightness; }

    // Shows what was set, in one of the next calls of poll().
    void show() { wanted_ = true; }
    void poll();

  protected:
    // What is not set here is zero: a strip has to be a global. Not constexpr: it would be kept in flash,
    // too.
    PixelStrip(uint8_t pin, uint8_t* colors, uint8_t count) : colors_(colors), pin_(pin), count_(count) {}

  private:
    bool send() const;

    uint8_t* colors_;  // as the pixels take them: green, red, blue
    uint8_t pin_;
    uint8_t count_;
    uint8_t brightness_;
    bool wanted_;
    uint16_t since_;  // microseconds; when it was last sent
};

template <uint8_t kCount>
class PixelStripOf : public PixelStrip {
  public:
    explicit PixelStripOf(uint8_t pin) : PixelStrip(pin, colors_, kCount) {}

  private:
    uint8_t colors_[3 * kCount];
};

}  // namespace asip
