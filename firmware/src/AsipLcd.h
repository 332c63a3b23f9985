// SPDX-License-Identifier: Apache-2.0
// A display of 128 x 64 pixels with an SH1106 at 0x3C on the I2C bus, as 5 lines of 21 characters:
//
//   asip::Lcd lcd;
//
// L,W,0,Hello writes a line (what stood there before is gone, what is too long is cut), L,C clears all,
// L,G,2,{0:50,1:100} draws bars of so many percent in their lines. A line is on the display within 42 ms, all
// of them within 150 ms, and the sketch does not wait. A display that is missing is error 8, pins in use
// elsewhere 9.
#pragma once

#include "Asip.h"
#include "asip/I2c.h"

namespace asip {

class Lcd : public Service {
  public:
    static constexpr uint8_t kLines = 5, kCharacters = 21;

    // What is not set here is zero: a display has to be a global.
    Lcd() : Service('L', kHoldsText) {}

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void poll() override;

  private:
    static constexpr uint8_t kCellColumns = 6;
    static constexpr uint8_t kAllPages = 0xFF;

    void startOver();
    void clear();
    Error write(Request& request);
    Error drawBars(Request& request);
    bool readBars(Request& request, bool apply);
    void changed(uint8_t line);
    bool startNext();
    void goOn();
    void fillCell();
    uint8_t column(const char* line, uint8_t cell, uint8_t index) const;

    char text_[kLines][kCharacters];  // or a bar: kBar and its percent
    uint8_t cell_[kCellColumns];      // under way to the display
    uint8_t stalePages_;              // a bit each
    uint8_t page_;
    uint8_t step_;  // of the setting up, or the cell of the page
    bool isSetUp_, isMissing_, isWaiting_;
};

}  // namespace asip
