#include "IoService.h"

#include "Board.h"
#include "Line.h"

namespace asip {

FlashText IoService::name() const {
    return F("ASIP core IO");
}

void IoService::begin() {
    channel_ = kIdle;
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
    const char tag = request.tag();
    switch (tag) {
        case 'P':
        case 'd':
        case 'a':
            break;
        case 'M':
        case 'p':
        case 'c':
        case 'm':
            if (!request.complete()) return Error::kBadArgument;
            board.sendList(*this, tag, tag == 'm' ? hw::kAnalogChannels : hw::kPins);
            return Error::kNone;
        default:
            return Error::kUnknownRequest;
    }
    const uint16_t pin = request.number();
    const uint8_t value = static_cast<uint8_t>(request.number(tag == 'd' ? 1 : 255));
    if (!request.complete()) return Error::kBadArgument;
    if (pin >= hw::kPins) return Error::kInvalidPin;
    if (tag == 'd') return writeDigital(static_cast<uint8_t>(pin), value != 0);
    if (tag == 'a') return writePwm(static_cast<uint8_t>(pin), value);
    return setMode(static_cast<uint8_t>(pin), value);
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

Error IoService::writeDigital(uint8_t pin, bool high) {
    const PinMode now = mode(pin);
    if (now == PinMode::kUnallocated || now > PinMode::kOutput) return Error::kWrongMode;
    hw::writePin(pin, high);
    return Error::kNone;
}

Error IoService::writePwm(uint8_t pin, uint8_t duty) {
    if (mode(pin) != PinMode::kPwm) return Error::kWrongMode;
    hw::writePwm(pin, duty);
    return Error::kNone;
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
    channel_ = 0;
}

// One conversion a pass: the six of a round together would hide what the inputs do for 0.7 ms.
void IoService::poll() {
    if (channel_ == kIdle) return;
    while (channel_ < hw::kAnalogChannels) {
        const uint8_t channel = channel_++;
        if (!isAnalogInput(channel)) continue;
        analog_[channel] = hw::readAnalog(channel);
        return;
    }
    if (!out.hasRoom()) return;
    channel_ = kIdle;
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
    out.number(analog_[channel]);
}

}  // namespace asip
