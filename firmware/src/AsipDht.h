// SPDX-License-Identifier: Apache-2.0
// Sensors of temperature and humidity with one data pin each, DHT11 or DHT22 (AM2302):
//
//   asip::Dht climate(asip::Dht::kDht22, 4);      // sensor 0 on pin 4; up to four pins
//
// C,M measures once, C,A,ms periodically; both are answered by @C,e,1,{21.50:45.20}, degrees Celsius and
// percent. A sensor that does not answer, or whose answer is damaged, has no value: @C,e,1,{}. C,E asks how
// often each was damaged and silent: @C,E,1,{3:0}.
//
// These sensors measure after they have answered, so what they tell is as old as the question before it. One
// that was not asked for five seconds is asked twice, and only the second answer counts: it comes two seconds
// later. The pins need an interrupt (docs/sensors.md says which have one); one that has none is not used.
#pragma once

#include "Asip.h"

namespace asip {

class Dht : public Service {
  public:
    // For how many milliseconds the line is low to wake it, from the data sheets: a DHT11 hears 18, an AM2302
    // hears 1 (20 at most).
    enum Kind : uint8_t { kDht11 = 20, kDht22 = 2 };
    static constexpr uint8_t kMaxSensors = 4;

    // Not constexpr: it would be kept in flash, too. A service has to be a global: what is not set here is
    // zero.
    template <typename... Pins>
    explicit Dht(Kind kind, Pins... pins)
        : Service('C', sizeof...(Pins)), pins_{static_cast<uint8_t>(pins)...}, kind_(kind) {
        static_assert(sizeof...(Pins) > 0 && sizeof...(Pins) <= kMaxSensors, "one to four sensors");
    }

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;
    void reportValues() override;  // starts to measure
    void poll() override;          // goes on measuring, and reports at the end

  private:
    enum State : uint8_t { kIdle, kResting, kNext, kWaking, kListening, kReporting };
    static constexpr int16_t kNoValue = -32768;

    struct Sensor {
        int16_t temperature, humidity;  // tenths
        uint8_t damaged, silent;        // answers, counted up to 255
    };

    Sensor& at(uint8_t sensor) __attribute__((noinline));
    void turnToNext();
    void take() __attribute__((noinline));
    int16_t tenths(const uint8_t* bytes) const __attribute__((noinline));

    Sensor sensors_[kMaxSensors];
    uint8_t pins_[kMaxSensors];
    uint8_t kind_;
    uint8_t state_;
    uint8_t sensor_;
    uint16_t sinceMs_;  // in this state, or since the sensors were asked
    bool isOld_;        // what they tell now
};

}  // namespace asip
