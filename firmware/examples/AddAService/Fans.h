// Two fans: F,W,fan,power sets the power of one; F,M and F,A,ms report their speeds.
#pragma once

#include <Asip.h>

class Fans : public asip::Service {
  public:
    static constexpr uint8_t kFans = 2;

    constexpr Fans() : Service('F', kFans), pulses_(), speeds_(), wasHigh_(), since_(0) {}

    asip::FlashText name() const override { return ASIP_NAME("Fan"); }
    void begin() override;
    asip::Error processRequest(asip::Request& request) override;
    void reportValue(uint8_t index) override;
    void poll() override;

  private:
    uint16_t pulses_[kFans];  // counted in this second
    uint16_t speeds_[kFans];  // turns a minute, in the last second
    bool wasHigh_[kFans];
    uint16_t since_;  // when this second began
};
