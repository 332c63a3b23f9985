// SPDX-License-Identifier: Apache-2.0
// The input/output service `I` that every board has, and with it the record of what each pin is used for.
#pragma once

#include "Hardware.h"
#include "Service.h"

namespace asip {

enum class PinMode : uint8_t {
    kUnallocated = 0,
    kInput = 1,
    kPullUp = 2,
    kOutput = 3,
    kAnalog = 4,
    kPwm = 5,
    kReserved = 6,
    kOtherService = 7,
};

class IoService : public Service {
  public:
    // Part of the one board, whose memory is zero before: writing the zeros again would take 60 bytes of
    // flash.
    IoService() : Service('I', 1) {}

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;
    void reportValues() override;

    // Sends an event for each port whose inputs changed. Called in each pass, as often as can be.
    void pollInputs();

    // Executes a digital write in its usual form, I,d,PIN,LEVEL, sooner than processRequest() could: what it
    // changes is reported before the rest of the request's work. False: it is another one, and nothing is
    // done.
    bool executeWrite(const char* line, uint8_t length);

    // Strict: every free pin begins unallocated. Otherwise as an input, analog pins as analog.
    void useStrictMode(bool strict) { strict_ = strict; }
    bool isStrict() const { return strict_; }

    PinMode mode(uint8_t pin) const { return static_cast<PinMode>(modes_[pin] & 15); }

    // Number that claim() gave to the service that uses the pin, 0 for the I/O service.
    uint8_t owner(uint8_t pin) const { return modes_[pin] >> 4; }
    bool isFree(uint8_t pin) const {
        return pin < hw::kPins && modes_[pin] < static_cast<uint8_t>(PinMode::kReserved);
    }
    Error claim(uint8_t pin, uint8_t owner);
    void release(uint8_t owner);

    static constexpr uint8_t kDigital = 1, kAnalogInput = 2, kPwmOutput = 4;
    static uint8_t capabilities(uint8_t pin);

  private:
    // Kept apart from one another: in one function they would each pay for the registers of all.
    Error pinRequest(Request& request) __attribute__((noinline));
    Error writeDigital(uint8_t pin, uint8_t high);
    Error writePwm(uint8_t pin, uint8_t duty) __attribute__((noinline));
    inline Error setMode(uint8_t pin, PinMode wanted) __attribute__((always_inline));
    void free(uint8_t pin);
    bool canWrite(uint8_t pin) const;
    void apply(uint8_t pin, PinMode mode);
    uint8_t inputLevels(uint8_t port) const;
    void sendPort(uint8_t port, uint8_t levels);
    bool isAnalogInput(uint8_t channel) const;
    uint8_t countAnalogInputs() const;
    static void writePort(uint8_t port, char separator, uint8_t mask);
    void writeAnalogInput(uint8_t nth);

    static constexpr uint8_t kPorts = hw::kLastPort - hw::kFirstPort + 1;
    uint8_t modes_[hw::kPins];  // mode in the low half, owner in the high
    uint8_t inputs_[kPorts];    // mask of the pins that are inputs
    uint8_t levels_[kPorts];    // as last reported
    bool strict_;
};

}  // namespace asip
