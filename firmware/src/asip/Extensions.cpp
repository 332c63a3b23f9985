// SPDX-License-Identifier: Apache-2.0
// The link extensions: echo, verified fence, identity, line rate, checksum.
#include "Board.h"
#include "Digest.h"
#include "Hex.h"
#include "Line.h"

namespace asip {

static constexpr uint8_t kArgument = 4;  // where the first argument begins: after #,I,

// A letter or digit; in a name also a point, a line or a dash.
static bool isAllowed(char c, bool inName) {
    if (static_cast<uint8_t>(c - '0') < 10 || static_cast<uint8_t>((c | 0x20) - 'a') < 26) return true;
    return inName && (c == '.' || c == '_' || c == '-');
}

// Whether `text` is a name, or a token, of 1 to `max` characters.
static bool isMadeOf(const char* text, bool name, uint8_t max) {
    const char* next = text;
    while (isAllowed(*next, name))
        ++next;
    return *next == '\0' && static_cast<uint8_t>(next - text - 1) < max;
}

Error Board::processExtension(Request& request) {
    switch (request.tag()) {
        case 'X':
            if (!request.complete()) return Error::kBadArgument;
            sendExtensions();
            return Error::kNone;
        case 'E':
        case 'V':
            return echo(request);
        case 'I':
            return identity(request);
        case 'B':
            return lineRate(request);
        case 'C':
            return checksum(request);
        default:
            return Error::kUnknownRequest;
    }
}

static const char kExtensionList[] PROGMEM = "7,{E:1,I:1,B:1,C:1,V:1,D:1,F:" ASIP_FIRMWARE_VERSION "}";

void Board::sendExtensions() {
    out.answer('#', 'X');
    if (longLineSize_ == 0) {
        out.text(flashText(kExtensionList));
    } else {
        out.text(F("8,{L:"));
        out.number(static_cast<uint8_t>(longLineSize_ - kBehindRequest));
        out.character(',');
        out.text(flashText(kExtensionList + 3));
    }
    out.end();
}

Error Board::echo(Request& request) {
    const char* const token = request.text();
    if (!isMadeOf(token, false, kMaxTokenLength)) return Error::kBadArgument;
    useExtensions(true);
    out.answer('#', request.tag());
    out.text(token);
    if (request.tag() == 'V') {
        out.character(',');
        out.number(digest_);
        digest_ = 0;
    }
    out.end();
    return Error::kNone;
}

// From 0, over the line and the '\0' at its end.
void Board::digestLine() {
    const char* next = line();
    char c;
    do {
        c = *next++;
        digest_ = digestOf(digest_, static_cast<uint8_t>(c));
    } while (c != '\0');
}

// In EEPROM, at its very end, away from what sketches keep: a check, the length, the name. The length is
// written last, the check covers all, so a board that loses power meanwhile has no name rather than a wrong
// one.
static constexpr uint16_t kCheckAddress = hw::kEepromEnd;
static constexpr uint16_t kLengthAddress = hw::kEepromEnd - 1;
static constexpr uint16_t kNameAddress = kLengthAddress - kMaxNameLength;

static uint8_t storedNameLength() {
    const uint8_t length = hw::readEeprom(kLengthAddress);
    if (length > kMaxNameLength) return 0;
    uint8_t check = static_cast<uint8_t>(length ^ hw::readEeprom(kCheckAddress));
    for (uint8_t i = 0; i < length; ++i) {
        const uint8_t c = hw::readEeprom(kNameAddress + i);
        if (!isAllowed(static_cast<char>(c), true)) return 0;
        check ^= c;
    }
    return check == 0x5A ? length : 0;
}

void Board::sendName() {
    out.answer('#', 'I');
    const uint8_t length = storedNameLength();
    for (uint8_t i = 0; i < length; ++i)
        out.character(static_cast<char>(hw::readEeprom(kNameAddress + i)));
    out.end();
}

Error Board::identity(Request& request) {
    if (request.complete()) {
        sendName();
        return Error::kNone;
    }
    const char* const name = request.text();
    if (!isMadeOf(name, true, kMaxNameLength)) return Error::kBadArgument;
    job_ = kStoreName;
    return Error::kNone;
}

// One byte a pass, when the EEPROM is ready: each takes 3.4 ms. The name stays in the request's line.
void Board::storeName() {
    if (!hw::eepromReady()) return;
    const char* const name = line() + kArgument;
    const uint8_t index = static_cast<uint8_t>(job_++ - kStoreName);
    uint8_t length = 0;
    uint8_t check = 0x5A;
    for (const char* next = name; *next != '\0'; ++next) {
        check ^= static_cast<uint8_t>(*next);
        ++length;
    }
    if (index < length) return hw::writeEeprom(kNameAddress + index, static_cast<uint8_t>(name[index]));
    if (index == length) return hw::writeEeprom(kCheckAddress, check ^ length);
    if (index == length + 1) return hw::writeEeprom(kLengthAddress, length);
    job_ = kNoJob;
    sendName();
}

// Hundreds of baud asked for by `text`, 0 if it is not a number of whole hundreds.
static uint16_t parseRate(const char* text) {
    uint16_t hundreds = 0;
    for (;; ++text) {
        if (text[0] == '0' && text[1] == '0' && text[2] == '\0') return hundreds;
        const uint8_t digit = static_cast<uint8_t>(*text - '0');
        if (digit > 9 || hundreds > 1000) return 0;
        hundreds = static_cast<uint16_t>(hundreds * 10 + digit);
    }
}

Error Board::lineRate(Request& request) {
    const char* const text = request.text();
    if (!line::isRate(parseRate(text))) return Error::kBadArgument;
    out.answer('#', 'B');
    out.text(text);
    out.end();
    job_ = kSwitchRate;
    out.hold(true);  // what came now would keep the line from falling idle
    return Error::kNone;
}

void Board::continueExtension() {
    if (job_ != kSwitchRate) return storeName();
    if (!line::idle()) return;
    // The request is still in its line, where no other is collected meanwhile.
    const uint16_t hundreds = parseRate(line() + kArgument);
    line::setRate(hundreds);
    useExtensions(hundreds != kDefaultRate);
    if (hundreds != kDefaultRate) waitMs_ = kRateTrialMs;
    job_ = kNoJob;
    out.hold(false);
}

// From an echo, a fence, a faster rate or checksums on until a peer turns one of the last two off again: it
// is to do both before it leaves the link to another one.
void Board::useExtensions(bool on) {
    next_ = on ? kExtended : 0;
    waitMs_ = 0;
}

void Board::giveUpRate() {
    useExtensions(false);
    line::setRate(kDefaultRate);
    length_ = 0;
    if ((longLineSize_ != 0 || hasBusyServices_) && job_ == kExecute) job_ = kNoJob;
}

Error Board::checksum(Request& request) {
    const uint16_t on = request.number(1);
    if (!request.complete()) return Error::kBadArgument;
    out.useChecksum(on != 0);
    useExtensions(on != 0);
    return Error::kNone;
}

// Checks *HH at the end of the line of `length` characters and cuts it off. One that is spoiled has three
// left, and no checksum whatever they are.
bool Board::acceptChecksum(uint8_t& length) {
    if (length <= 3) return false;
    char* const line = this->line();
    length = static_cast<uint8_t>(length - 3);
    char* const end = line + length;
    const uint8_t high = hexValue(end[1]);
    const uint8_t low = hexValue(end[2]);
    if (*end != '*' || (high | low) > 15) return false;
    *end = '\0';
    uint8_t sum = static_cast<uint8_t>(high << 4 | low);
    for (const char* next = line; *next != '\0'; ++next)
        sum ^= static_cast<uint8_t>(*next);
    return sum == 0;
}

}  // namespace asip
