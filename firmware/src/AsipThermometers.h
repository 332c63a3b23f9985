// SPDX-License-Identifier: Apache-2.0
// Thermometers on a 1-Wire bus, DS18B20 and its kin (DS18S20, DS1822, MAX31820), any number on one pin with a
// resistor of 4.7 kOhm to the supply:
//
//   asip::OneWireBus bus(2);
//   asip::ThermometersOf<8> thermometers(bus);      // room for eight, twelve bytes of RAM each
//
// K,M measures once, K,A,ms periodically; both are answered by @K,e,2,{21.50,-3.06} degrees Celsius, with
// nothing in the place of a thermometer that did not answer. A measurement takes 0.8 seconds, for which
// nothing waits. K,I asks for their ids, @K,I,2,{28AA...,28BB...}, K,E how often each was damaged and silent,
// @K,E,2,{0:0,1:7}.
//
// They are looked for at the start, by K,S, and, where none is known, by K,M and at each period; one that was
// found keeps its place until the board restarts. K,M is answered by ~K,e,8 where none is found, and by
// ~K,e,4 where one is powered by its data line alone: each needs its supply pin.
#pragma once

#include "Asip.h"
#include "asip/OneWireBus.h"

namespace asip {

class Thermometers : public Service {
  public:
    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void reportValue(uint8_t index) override;
    void reportValues() override;  // starts to measure
    void poll() override;          // goes on, and reports at the end

  protected:
    static constexpr uint8_t kIdBytes = 8;  // with its checksum
    struct Thermometer {
        uint8_t id[kIdBytes];
        int16_t sixteenths;
        uint8_t damaged, silent;  // answers, counted up to 255
    };

    // A service has to be a global: what is not set here is zero.
    Thermometers(OneWireBus& bus, Thermometer* all, uint8_t room)
        : Service('K'), bus_(bus), all_(all), room_(room) {}

  private:
    // From kSearch on they have the bus.
    enum Task : uint8_t { kIdle, kWait, kReport, kReportIds, kSearch, kAskPower, kPrepare, kConvert, kRead };

    // To measure, by a request or by a period; to search, and to answer by the list.
    enum : uint8_t { kByRequest = 1, kByPeriod = 2, kList = 4 };

    bool canMeasure() const;
    void turnTo(Task task);
    bool startTask();
    void finishTask(OneWireBus::Result result);
    void found();
    void take(bool done);
    void finishSearch();

    OneWireBus& bus_;
    Thermometer* all_;
    uint8_t room_;
    uint8_t known_;
    uint8_t task_;
    uint8_t index_;  // of the thermometer that is read
    uint8_t round_;  // is written into each before it measures
    uint8_t branch_;
    uint8_t damagedIds_;  // that a search found, one behind another
    uint16_t sinceMs_;    // they measure
    bool isStarted_;      // the task has the bus
    uint8_t wanted_;
    bool hasParasite_;
    uint8_t bytes_[10];
};

template <uint8_t kRoom>
class ThermometersOf : public Thermometers {
  public:
    explicit ThermometersOf(OneWireBus& bus) : Thermometers(bus, thermometers_, kRoom) {}

  private:
    static_assert(kRoom > 0 && kRoom <= 32, "one to 32 thermometers");
    Thermometer thermometers_[kRoom];
};

}  // namespace asip
