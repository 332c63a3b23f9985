// SPDX-License-Identifier: Apache-2.0
// The one TCP client of the board: a newer one takes the place of the older, one that is silent for 30 s is
// dropped.
#pragma once

#include <Arduino.h>

template <class ClientType>
class NewestClient {
  public:
    static constexpr uint32_t kIdleMs = 30000;

    void take(const ClientType& next, uint32_t nowMs) {
        client_.stop();
        client_ = next;
        heardMs_ = nowMs;
    }

    // Gives what came to `taker`, a piece at a time; what finds no room waits.
    template <class Taker>
    void poll(Taker taker, uint32_t nowMs) {
        while (left_ > 0 || client_.available() > 0) {
            if (left_ == 0) {
                byte_ = static_cast<uint8_t>(client_.read());
                left_ = 1;
                heardMs_ = nowMs;
            }
            if (!taker(&byte_, 1)) return;
            left_ = 0;
        }
        if (client_.connected() && nowMs - heardMs_ >= kIdleMs) client_.stop();
    }

    void write(const char* bytes, uint16_t length) {
        if (client_.connected()) client_.write(reinterpret_cast<const uint8_t*>(bytes), length);
    }

  private:
    ClientType client_;
    uint32_t heardMs_ = 0;
    uint8_t byte_ = 0;
    uint8_t left_ = 0;
};
