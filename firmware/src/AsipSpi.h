// SPDX-License-Identifier: Apache-2.0
// Any chip on the SPI pins of an AVR, for programs that know it:
//
//   asip::Spi spi(10, 9);      // the pins that choose a chip, one to four, high while it is not chosen
//
// V,t,10,1000,0,0,018000 chooses the chip at pin 10, writes three bytes at 1000 kHz or the next lower rate in
// mode 0 and reads as many, @V,t,0003FF, 16 at most; pin 255 chooses none. The slowest rate is a 128th of the
// clock, 125 kHz at 16 MHz: whoever asks for less gets that. V,t,10,1000,0,1,... keeps the chip chosen for
// what follows, for 250 ms at most; another one is error 8 meanwhile.
#pragma once

#if defined(ARDUINO) && !defined(__AVR__)
#error "AsipSpi.h drives the SPI of an AVR: there is none on this chip"
#endif

#include "Asip.h"

namespace asip {

class Spi : public Service {
  public:
    static constexpr uint8_t kMaxBytes = 16, kMaxChips = 4, kNoPin = 255;

    // A service has to be a global: what is not set here is zero.
    template <typename... Pins>
    explicit Spi(Pins... pins)
        : Service('V', kHoldsText), pins_{static_cast<uint8_t>(pins)...}, pinCount_(sizeof...(Pins)) {
        static_assert(sizeof...(Pins) > 0 && sizeof...(Pins) <= kMaxChips, "one to four chips");
    }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void poll() override;

  private:
    enum Step : uint8_t { kIdle, kUnderWay, kAnswering };

    void choose(bool on);

    uint8_t pins_[kMaxChips];
    uint8_t pinCount_;
    bool isAvailable_, isKept_, keeps_;
    Step step_;
    uint8_t chosen_;  // pin
    uint8_t count_, at_;
    uint8_t sinceMs_;
    uint8_t bytes_[kMaxBytes];
};

}  // namespace asip
