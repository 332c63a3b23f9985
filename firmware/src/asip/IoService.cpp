#include "IoService.h"

#include "Board.h"
#include "Line.h"

namespace asip {

FlashText IoService::name() const {
    return F("ASIP core IO");
}

void IoService::begin() {
    preparedPin_ = kNoPin;
    for (uint8_t port = 0; port < kPorts; ++port)
        inputs_[port] = 0;
    for (uint8_t pin = 0; pin < hw::kPins; ++pin) {
        if (line::usesPin(pin)) {
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
    uint8_t bits = 1;
    if (hw::isAnalog(pin)) bits |= 2;
    if (hw::hasPwm(pin)) bits |= 4;
    return bits;
}

Error IoService::processRequest(Request& request) {
    switch (request.tag()) {
        case 'd':
            return digitalRequest(request);
        case 'a':
            return pwmRequest(request);
        case 'P':
            return modeRequest(request);
        case 'M':
        case 'p':
        case 'c':
            return listRequest(request, hw::kPins);
        case 'm':
            return listRequest(request, hw::kAnalogChannels);
        default:
            return Error::kUnknownRequest;
    }
}

Error IoService::listRequest(Request& request, uint8_t count) {
    if (!request.complete()) return Error::kBadArgument;
    board.sendList(*this, request.tag(), count);
    return Error::kNone;
}

bool IoService::canWrite(uint8_t pin) const {
    const PinMode now = mode(pin);
    return now >= PinMode::kInput && now <= PinMode::kOutput;
}

Error IoService::digitalRequest(Request& request) {
    const uint16_t pin = request.number();
    const uint16_t high = request.number(1);
    if (!request.complete()) return Error::kBadArgument;
    if (pin >= hw::kPins) return Error::kInvalidPin;
    if (!canWrite(static_cast<uint8_t>(pin))) return Error::kWrongMode;
    hw::writePin(static_cast<uint8_t>(pin), high != 0);
    return Error::kNone;
}

void IoService::prepare(const char* line, uint8_t length) {
    // I,d,2,1 or I,d,13,1
    if (line[length - 2] != ',' || line[0] != 'I' || line[1] != ',' || line[2] != 'd' || line[3] != ',')
        return;
    const uint8_t level = static_cast<uint8_t>(line[length - 1] - '0');
    uint8_t pin = static_cast<uint8_t>(line[4] - '0');
    if (level > 1 || pin > 9) return;
    if (length == kLongestWrite) {
        const uint8_t digit = static_cast<uint8_t>(line[5] - '0');
        if (digit > 9) return;
        pin = static_cast<uint8_t>(pin * 10 + digit);
    }
    if (pin >= hw::kPins || !canWrite(pin)) return;
    preparedPin_ = pin;
    preparedLevel_ = level;
}

bool IoService::executePrepared() {
    const uint8_t pin = preparedPin_;
    if (pin == kNoPin) return false;
    preparedPin_ = kNoPin;
    hw::writePin(pin, preparedLevel_);
    return true;
}

Error IoService::pwmRequest(Request& request) {
    const uint16_t pin = request.number();
    const uint16_t duty = request.number(255);
    if (!request.complete()) return Error::kBadArgument;
    if (pin >= hw::kPins) return Error::kInvalidPin;
    if (mode(static_cast<uint8_t>(pin)) != PinMode::kPwm) return Error::kWrongMode;
    hw::writePwm(static_cast<uint8_t>(pin), static_cast<uint8_t>(duty));
    return Error::kNone;
}

Error IoService::modeRequest(Request& request) {
    const uint16_t pin = request.number();
    const uint16_t mode = request.number(255);
    if (!request.complete()) return Error::kBadArgument;
    if (pin >= hw::kPins) return Error::kInvalidPin;
    return setMode(static_cast<uint8_t>(pin), static_cast<uint8_t>(mode));
}

Error IoService::setMode(uint8_t pin, uint8_t mode) {
    if (mode > static_cast<uint8_t>(PinMode::kPwm)) return Error::kInvalidMode;
    if (!isFree(pin)) return Error::kModeUnavailable;
    const PinMode wanted = static_cast<PinMode>(mode);
    const uint8_t has = capabilities(pin);
    if (wanted == PinMode::kAnalog && !(has & 2)) return Error::kModeUnavailable;
    if (wanted == PinMode::kPwm && !(has & 4)) return Error::kModeUnavailable;
    if (this->mode(pin) == PinMode::kPwm) hw::writePin(pin, false);
    apply(pin, wanted);
    if (wanted == PinMode::kInput || wanted == PinMode::kPullUp) {
        const uint8_t port = static_cast<uint8_t>(hw::portOf(pin) - hw::kFirstPort);
        sendPort(port, static_cast<uint8_t>(hw::readPort(hw::portOf(pin)) & inputs_[port]));
    }
    return Error::kNone;
}

void IoService::apply(uint8_t pin, PinMode mode) {
    const uint8_t port = static_cast<uint8_t>(hw::portOf(pin) - hw::kFirstPort);
    const uint8_t mask = hw::maskOf(pin);
    modes_[pin] = static_cast<uint8_t>(mode);
    const bool isInput = mode == PinMode::kInput || mode == PinMode::kPullUp;
    if (mode == PinMode::kPullUp) {
        hw::setPullUp(pin);
    } else if (mode == PinMode::kOutput || mode == PinMode::kPwm) {
        hw::setOutput(pin);
    } else {
        hw::setInput(pin);
    }
    // A pin's level counts as reported when it becomes an input; what it does later is an event.
    inputs_[port] = static_cast<uint8_t>(isInput ? inputs_[port] | mask : inputs_[port] & ~mask);
    const uint8_t level = static_cast<uint8_t>(isInput ? hw::readPort(hw::portOf(pin)) & mask : 0);
    levels_[port] = static_cast<uint8_t>((levels_[port] & ~mask) | level);
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

void IoService::sendPort(uint8_t port, uint8_t levels) {
    levels_[port] = levels;
    out.event('I', 'd');
    out.character(',');
    out.number(static_cast<uint8_t>(hw::kFirstPort + port));
    out.character(',');
    out.hexByte(levels);
    out.end();
}

void IoService::reportValues() {
    const uint8_t count = countAnalogInputs();
    if (count != 0) board.sendList(*this, 'a', count);
}

bool IoService::isAnalogInput(uint8_t channel) const {
    return mode(static_cast<uint8_t>(hw::kFirstAnalogPin + channel)) == PinMode::kAnalog;
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
            return writePortAndMask(index);
        case 'm':
            out.number(static_cast<uint8_t>(hw::kFirstAnalogPin + index));
            out.character(':');
            return out.number(index);
        case 'p':
            return out.number(static_cast<uint8_t>(mode(index)));
        case 'c':
            return out.number(capabilities(index));
        default:
            return writeAnalogInput(index);
    }
}

void IoService::writePortAndMask(uint8_t pin) {
    out.number(hw::portOf(pin));
    out.character(':');
    out.hexByte(hw::maskOf(pin));
}

void IoService::writeAnalogInput(uint8_t nth) {
    uint8_t channel = 0;
    while (!isAnalogInput(channel) || nth-- > 0)
        ++channel;
    out.number(channel);
    out.character(':');
    out.number(hw::readAnalog(channel));
}

}  // namespace asip
