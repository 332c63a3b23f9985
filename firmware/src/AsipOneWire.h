// SPDX-License-Identifier: Apache-2.0
// Any device on a 1-Wire bus, for programs that know it:
//
//   asip::OneWireBus bus(2);
//   asip::OneWire oneWire(bus);
//
// O,R resets the bus: @O,R,1 if a device answers, else 0. O,S,n gives the id of the n-th device, from 0:
// @O,S,28FF641D8316036C, or @O,S, where there are fewer. O,T,9,CCBE resets, writes the bytes and reads nine:
// @O,T,910150...; O,t does it without the reset. At most 16 bytes each way. Where no device answers, or the
// line is low, it is error 8 in place of the answer. Requests to the service wait for the answer to the one
// before. Thermometers may share the bus: asip::OneWireBus has one user at a time.
#pragma once

#include "Asip.h"
#include "asip/OneWireBus.h"

namespace asip {

class OneWire : public Service {
  public:
    static constexpr uint8_t kMaxBytes = 16;

    // A service has to be a global: what is not set here is zero.
    explicit OneWire(OneWireBus& bus) : Service('O', kHoldsText), bus_(bus) {}

    FlashText name() const override;
    void begin() override;
    Error processRequest(Request& request) override;
    void poll() override;

  private:
    bool start();
    void answer();
    void answerBytes();
    void finish();

    OneWireBus& bus_;
    char tag_;  // of the request under way, 0 for none
    bool isStarted_;
    uint8_t result_;
    uint8_t outCount_, inCount_;
    uint8_t left_;  // devices to be found before the one that is asked for
    uint8_t branch_;
    uint8_t bytes_[kMaxBytes];
};

}  // namespace asip
