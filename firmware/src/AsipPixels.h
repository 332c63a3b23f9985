// SPDX-License-Identifier: Apache-2.0
// A strip of WS2812 pixels (NeoPixel), on an AVR:
//
//   asip::Pixels<18> pixels(6);      // 18 pixels on pin 6
//
// P,P,2,{0:255,3:16711680} sets single pixels, P,S,3,4,{255,0,65280} three of them from the fifth on, P,B,128
// their brightness; each shows at once. P,I is answered by @P,I,18. A color is red * 65536 + green * 256 +
// blue. The board then takes requests long enough to set 26 pixels at once, all of them if there are fewer.
// RAM: 3 bytes a pixel and 9 for its place in a request.
#pragma once

#if defined(ARDUINO) && !defined(__AVR__)
#error "AsipPixels.h sends to its pixels in the cycles of an AVR, which this chip is not"
#endif

#include "Asip.h"
#include "asip/parts/PixelStrip.h"

namespace asip {

class PixelService : public Service {
  public:
    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void poll() override { strip_.poll(); }

  protected:
    PixelService(PixelStrip& strip, char* line, uint8_t lineSize)
        : Service('P'), strip_(strip), line_(line), lineSize_(lineSize) {}

  private:
    enum Pass : uint8_t { kCheck, kApply };
    Error setPixels(Request& request);
    Error readPairs(Request& request, Pass pass);
    Error readRow(Request& request, Pass pass);
    void setColor(uint16_t pixel, uint32_t color);

    PixelStrip& strip_;
    char* line_;
    uint8_t lineSize_;
};

template <uint8_t kCount>
class Pixels : public PixelService {
  public:
    explicit Pixels(uint8_t pin) : PixelService(strip_, line_, kLineSize), strip_(pin) {}

  private:
    // P,S,18,0,{ and a color of eight digits with a comma for each, up to what a request may have.
    static constexpr uint8_t kLineSize = kCount >= 27 ? 250 : 10 + 9 * kCount + kBehindRequest;

    PixelStripOf<kCount> strip_;
    char line_[kLineSize];
};

}  // namespace asip
