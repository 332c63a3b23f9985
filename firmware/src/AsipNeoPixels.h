// SPDX-License-Identifier: Apache-2.0
// Strips of WS2812 pixels (NeoPixel) that are set pixel by pixel and then shown, on an AVR:
//
//   asip::PixelStripOf<8> left(5), right(6);
//   asip::NeoPixels neopixels(left, right);      // strips 0 and 1
//
// N,C,1,7,255,128,0 sets pixel 7 of strip 1 to that red, green and blue, N,B,1,40 its brightness, N,S,1 shows
// both.
#pragma once

#if defined(ARDUINO) && !defined(__AVR__)
#error "AsipNeoPixels.h sends to its pixels in the cycles of an AVR, which this chip is not"
#endif

#include "Asip.h"
#include "asip/parts/PixelStrip.h"

namespace asip {

class NeoPixels : public Service {
  public:
    static constexpr uint8_t kMaxStrips = 4;

    template <typename... Strips>
    explicit NeoPixels(Strips&... strips) : Service('N'), strips_{&strips...}, count_(sizeof...(Strips)) {
        static_assert(sizeof...(Strips) <= kMaxStrips, "too many strips");
    }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void poll() override;

  private:
    Error setColor(Request& request, PixelStrip& strip);

    PixelStrip* strips_[kMaxStrips];
    uint8_t count_;
};

}  // namespace asip
