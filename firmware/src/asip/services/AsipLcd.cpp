// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#ifdef ARDUINO

#include "AsipLcd.h"

#include "asip/parts/Font.h"

namespace asip {

// From the data sheet of the SH1106. Its memory has 132 columns, of which the display shows those from the
// third on, in eight pages of eight rows.
static constexpr uint8_t kAddress = 0x3C;
static constexpr uint8_t kCommands = 0x00, kData = 0x40;  // what the bytes of a transfer are
static constexpr uint8_t kPageCommand = 0xB0, kFirstColumnLow = 0x02, kFirstColumnHigh = 0x10;
static constexpr uint8_t kSetUp[][6] PROGMEM = {
    {0xAE, 0xD5, 0x80, 0xA8, 0x3F, 0x40},  // off; clock; 64 rows; the first is the top
    {0xD3, 0x00, 0xAD, 0x8B, 0xA1, 0xC8},  // no offset; its own supply; upright
    {0xDA, 0x12, 0x81, 0x80, 0xA4, 0xA6},  // rows in turn; contrast; shows its memory; light on dark
    {0xD9, 0x22, 0xDB, 0x35, 0xAF, 0xE3},  // charge times; voltage; on
};
static constexpr uint8_t kSetUpSteps = sizeof kSetUp / sizeof kSetUp[0];

static constexpr uint8_t kPages = 8;
static constexpr char kBar = 1;
static constexpr uint8_t kBarColumn = 0x3E, kEmptyColumn = 0x20;

// Lines are 12 rows apart: two of them lie across two pages.
static uint8_t lineOf(uint8_t page) {
    return static_cast<uint8_t>((2 * page + 1) / 3);
}
static constexpr uint8_t kNoLine = Lcd::kLines;

FlashText Lcd::name() const {
    return ASIP_NAME("LCD");
}

void Lcd::begin() {
    I2c::begin(*this);
    isMissing_ = isWaiting_ = false;
    clear();
    startOver();
}

void Lcd::startOver() {
    isSetUp_ = false;
    step_ = 0;
    stalePages_ = kAllPages;
}

void Lcd::clear() {
    for (char(&line)[kCharacters] : text_)
        for (char& character : line)
            character = ' ';
    stalePages_ = kAllPages;
}

Error Lcd::processRequest(Request& request) {
    const char tag = request.tag();
    if (tag != 'W' && tag != 'C' && tag != 'G') return Error::kUnknownRequest;
    if (!I2c::isEnabled()) return Error::kI2cNotEnabled;
    if (isMissing_) {
        isMissing_ = false;  // is looked for again
        return Error::kDeviceNotAvailable;
    }
    if (tag == 'W') return write(request);
    if (tag == 'G') return drawBars(request);
    if (!request.complete()) return Error::kBadArgument;
    clear();
    return Error::kNone;
}

Error Lcd::write(Request& request) {
    const uint16_t line = request.number();
    const char* next = request.text();
    if (!request.good()) return Error::kBadArgument;
    if (line >= kLines) return Error::kInvalidDeviceNumber;
    for (char& character : text_[line]) {
        character = ' ';
        if (*next != '\0') character = *next++;
        if (character < kFirstGlyph || character > kLastGlyph) character = '?';
    }
    changed(static_cast<uint8_t>(line));
    return Error::kNone;
}

// Read twice: nothing of a request is done before all of it is known to be good.
Error Lcd::drawBars(Request& request) {
    Request again = request;
    const bool there = readBars(request, false);
    if (!request.complete()) return Error::kBadArgument;
    if (!there) return Error::kInvalidDeviceNumber;
    readBars(again, true);
    return Error::kNone;
}

bool Lcd::readBars(Request& request, bool apply) {
    bool there = true;
    uint16_t left = request.number();
    request.expect(',');
    for (char before = '{'; left > 0 && request.good(); --left, before = ',') {
        request.expect(before);
        const uint8_t line = static_cast<uint8_t>(request.item(255));
        request.expect(':');
        const uint8_t percent = static_cast<uint8_t>(request.item(100));
        if (line >= kLines) there = false;
        if (!apply) continue;
        text_[line][0] = kBar;
        text_[line][1] = static_cast<char>(percent);
        changed(line);
    }
    request.expect('}');
    return there;
}

void Lcd::changed(uint8_t line) {
    for (uint8_t page = 0; page < kPages; ++page)
        if (lineOf(page) == line) stalePages_ |= static_cast<uint8_t>(1 << page);
}

// A cell of six columns at a time: other services get the bus in between.
void Lcd::poll() {
    if (isMissing_) return;
    if (!isWaiting_) {
        isWaiting_ = startNext();
        return;
    }
    const I2c::Result result = I2c::finish();
    if (result == I2c::kBusy) return;
    isWaiting_ = false;
    if (result == I2c::kDone) return goOn();
    isMissing_ = true;
    startOver();
}

// Step 0 of a page says where it begins; the cells follow, and two columns at its end.
bool Lcd::startNext() {
    if (!isSetUp_) {
        for (uint8_t i = 0; i < sizeof cell_; ++i)
            cell_[i] = pgm_read_byte(&kSetUp[step_][i]);
        return I2c::start(kAddress, kCommands, cell_, sizeof cell_, nullptr, 0);
    }
    if (step_ == 0) {
        if (stalePages_ == 0) return false;
        for (page_ = 0; !(stalePages_ & 1 << page_);)
            ++page_;
        cell_[0] = kPageCommand | page_;
        cell_[1] = kFirstColumnLow;
        cell_[2] = kFirstColumnHigh;
        if (!I2c::start(kAddress, kCommands, cell_, 3, nullptr, 0)) return false;
        stalePages_ &= static_cast<uint8_t>(~(1 << page_));
        return true;
    }
    fillCell();
    return I2c::start(kAddress, kData, cell_, step_ > kCharacters ? 2 : kCellColumns, nullptr, 0);
}

void Lcd::goOn() {
    ++step_;
    if (step_ < (isSetUp_ ? kCharacters + 2 : kSetUpSteps)) return;
    isSetUp_ = true;
    step_ = 0;
}

void Lcd::fillCell() {
    const uint8_t line = lineOf(page_);
    for (uint8_t i = 0; i < kCellColumns; ++i) {
        uint8_t rows = 0;
        if (line < kNoLine && step_ <= kCharacters)
            rows = column(text_[line], static_cast<uint8_t>(step_ - 1), i);
        // Line 1 begins in the middle of page 1, line 3 in that of page 4.
        if (page_ % 3 == 1) rows = static_cast<uint8_t>(rows << 4);
        if (page_ % 3 == 2) rows >>= 4;
        cell_[i] = rows;
    }
}

uint8_t Lcd::column(const char* line, uint8_t cell, uint8_t index) const {
    if (line[0] == kBar) {
        const uint8_t filled = static_cast<uint8_t>(static_cast<uint8_t>(line[1]) * 63 / 50);  // of 126
        return static_cast<uint8_t>(cell * kCellColumns + index) < filled ? kBarColumn : kEmptyColumn;
    }
    if (index == kGlyphColumns) return 0;
    return pgm_read_byte(&kFont[line[cell] - kFirstGlyph][index]);
}

}  // namespace asip

#endif
