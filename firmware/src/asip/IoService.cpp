// SPDX-License-Identifier: Apache-2.0
#include "IoService.h"

#include "Board.h"
#include "Line.h"

namespace asip {

FlashText IoService::name() const {
    return ASIP_NAME("ASIP core IO");
}

void IoService::begin() {
    for (uint8_t pin = 0; pin < hw::kPins; ++pin) {
        if (line::usesPin(pin) || hw::isHidden(pin)) {
            modes_[pin] = static_cast<uint8_t>(PinMode::kReserved);
            continue;
        }
        free(pin);
    }
}

// Back to what it is at start.
void IoService::free(uint8_t pin) {
    hw::writePin(pin, false);  // ends PWM
    PinMode mode = hw::isAnalog(pin) ? PinMode::kAnalog : PinMode::kInput;
    if (strict_ || hw::isAlias(pin)) mode = PinMode::kUnallocated;
    apply(pin, mode);
}

void IoService::release(uint8_t owner) {
    for (uint8_t pin = 0; pin < hw::kPins; ++pin) {
        if (this->owner(pin) == owner) free(pin);
    }
}

Error IoService::claim(uint8_t pin, uint8_t owner) {
    if (!isFree(pin)) return Error::kInvalidPin;
    apply(pin, PinMode::kUnallocated);
    modes_[pin] = static_cast<uint8_t>(static_cast<uint8_t>(PinMode::kOtherService) | (owner << 4));
    return Error::kNone;
}

uint8_t IoService::capabilities(uint8_t pin) {
    uint8_t bits = hw::isAnalogOnly(pin) ? 0 : kDigital;
    if (hw::isAnalog(pin)) bits |= kAnalogInput;
    if (hw::hasPwm(pin)) bits |= kPwmOutput;
    return bits;
}

Error IoService::processRequest(Request& request) {
    uint8_t count = hw::kPins;
    switch (request.tag()) {
        case 'd':
        case 'a':
        case 'P':
            return pinRequest(request);
        case 'M':
        case 'p':
        case 'c':
            break;
        case 'm':
            count = hw::kAnalogChannels;
            break;
        case 'L':
            if (!kExtensions) return Error::kUnknownRequest;
            count = kPorts;
            break;
        default:
            return Error::kUnknownRequest;
    }
    if (!request.complete()) return Error::kBadArgument;
    board.sendList(*this, request.tag(), count);
    return Error::kNone;
}

Error IoService::pinRequest(Request& request) {
    const uint16_t pin = request.number();
    const uint8_t value = static_cast<uint8_t>(request.number(255));
    if (!request.complete()) return Error::kBadArgument;
    if (pin >= hw::kPins) return Error::kInvalidPin;
    if (hw::isBusPin(pin)) return Error::kI2cNotEnabled;
    if (request.tag() == 'd') return writeDigital(static_cast<uint8_t>(pin), value);
    if (request.tag() == 'a') return writePwm(static_cast<uint8_t>(pin), value);
    if (value > static_cast<uint8_t>(PinMode::kPwm)) return Error::kInvalidMode;
    return setMode(static_cast<uint8_t>(pin), static_cast<PinMode>(value));
}

bool IoService::canWrite(uint8_t pin) const {
    return static_cast<uint8_t>(modes_[pin] - 1) < 3;  // of no owner: an owner's number is in the high half
}

Error IoService::writeDigital(uint8_t pin, uint8_t high) {
    if (!canWrite(pin)) return Error::kWrongMode;
    hw::writePin(pin, high != 0);
    return Error::kNone;
}

bool IoService::executeWrite(const char* line, uint8_t length) {
    // I,d,2,1 or I,d,13,1
    constexpr uint8_t kOneDigit = 7, kTwoDigits = 8;
    if (length != kOneDigit && length != kTwoDigits) return false;
    if (line[0] != 'I' || line[1] != ',' || line[2] != 'd' || line[3] != ',') return false;
    uint8_t pin = static_cast<uint8_t>(line[4] - '0');
    if (pin > 9) return false;
    if (length == kTwoDigits) {
        const uint8_t digit = static_cast<uint8_t>(line[5] - '0');
        if (digit > 9) return false;
        pin = static_cast<uint8_t>(pin * 10 + digit);
        ++line;
    }
    const uint8_t level = static_cast<uint8_t>(line[6] - '0');
    if (line[5] != ',' || level > 1 || pin >= hw::kPins || !canWrite(pin)) return false;
    hw::writePin(pin, level);
    return true;
}

// As 0.4 does: the pin need not be in PWM mode before, only free.
Error IoService::writePwm(uint8_t pin, uint8_t duty) {
    if (setMode(pin, PinMode::kPwm) != Error::kNone) return Error::kInvalidPin;
    hw::writePwm(pin, duty);
    return Error::kNone;
}

inline Error IoService::setMode(uint8_t pin, PinMode wanted) {
    const uint8_t has = capabilities(pin);
    if (!isFree(pin) || (wanted == PinMode::kAnalog && !(has & kAnalogInput)) ||
        (wanted == PinMode::kPwm && !(has & kPwmOutput)))
        return Error::kModeUnavailable;
    if (hw::kHasAnalogOnlyPins && wanted >= PinMode::kInput && wanted <= PinMode::kOutput &&
        !(has & kDigital))
        return Error::kModeUnavailable;
    apply(pin, wanted);
    if (wanted == PinMode::kInput || wanted == PinMode::kPullUp) {
        const uint8_t port = static_cast<uint8_t>(hw::portOf(pin) - hw::kFirstPort);
        sendPort(port, inputLevels(port));
    }
    return Error::kNone;
}

void IoService::apply(uint8_t pin, PinMode mode) {
    // Ends a PWM that is on, whatever service takes the pin now.
    if (modes_[pin] == static_cast<uint8_t>(PinMode::kPwm) && mode != PinMode::kPwm) hw::writePin(pin, false);
    modes_[pin] = static_cast<uint8_t>(mode);
    if (hw::isAnalogOnly(pin)) return;
    const uint8_t port = static_cast<uint8_t>(hw::portOf(pin) - hw::kFirstPort);
    const uint8_t mask = hw::maskOf(pin);
    const bool isInput = mode == PinMode::kInput || mode == PinMode::kPullUp;
    if (mode == PinMode::kPullUp) {
        hw::setPullUp(pin);
    } else if (mode == PinMode::kOutput || mode == PinMode::kPwm) {
        hw::setOutput(pin);
    } else {
        hw::setInput(pin);
    }
    // A pin counts as reported low when it becomes an input: one that is high is an event.
    uint8_t inputs = static_cast<uint8_t>(inputs_[port] & ~mask);
    if (isInput) inputs |= mask;
    inputs_[port] = inputs;
    levels_[port] = static_cast<uint8_t>(levels_[port] & ~mask);
}

void IoService::pollInputs() {
    for (uint8_t port = 0; port < kPorts; ++port) {
        const uint8_t mask = inputs_[port];
        if (mask == 0) continue;
        const uint8_t levels = static_cast<uint8_t>(hw::readPort(hw::kFirstPort + port) & mask);
        // A line that is full keeps the change for later: the last state always gets through.
        if (levels != levels_[port] && out.hasRoom()) sendPort(port, levels);
    }
}

uint8_t IoService::inputLevels(uint8_t port) const {
    return static_cast<uint8_t>(hw::readPort(hw::kFirstPort + port) & inputs_[port]);
}

void IoService::sendPort(uint8_t port, uint8_t levels) {
    levels_[port] = levels;
    out.answer('I', 'd');
    writePort(static_cast<uint8_t>(hw::kFirstPort + port), ',', levels);
    out.end();
}

void IoService::reportValues() {
    const uint8_t count = countAnalogInputs();
    if (count != 0) board.sendList(*this, 'a', count);
}

bool IoService::isAnalogInput(uint8_t channel) const {
    return modes_[hw::kFirstAnalogPin + channel] == static_cast<uint8_t>(PinMode::kAnalog);
}

uint8_t IoService::countAnalogInputs() const {
    uint8_t count = 0;
    for (uint8_t channel = 0; channel < hw::kAnalogChannels; ++channel)
        count += isAnalogInput(channel);
    return count;
}

void IoService::reportValue(uint8_t index) {
    switch (board.listTag()) {
        case 'M':
            return writePort(hw::portOf(index), ':', hw::maskOf(index));
        case 'm':
            out.number(static_cast<uint8_t>(hw::kFirstAnalogPin + index));
            out.character(':');
            return out.number(index);
        case 'p':
            return out.number(static_cast<uint8_t>(mode(index)));
        case 'c':
            return out.number(capabilities(index));
        case 'L':
            return writePort(static_cast<uint8_t>(hw::kFirstPort + index), ':', inputLevels(index));
        default:
            return writeAnalogInput(index);
    }
}

void IoService::writePort(uint8_t port, char separator, uint8_t mask) {
    out.number(port);
    out.character(separator);
    out.hexByte(mask);
}

void IoService::writeAnalogInput(uint8_t nth) {
    uint8_t channel = 255;
    do {
        if (isAnalogInput(++channel)) --nth;
    } while (nth != 255);
    out.number(channel);
    out.character(':');
    out.number(hw::readAnalog(channel));
}

}  // namespace asip
