// SPDX-License-Identifier: Apache-2.0
// A board that takes part in the ASIP bus by itself, with no agent: its names on the first two rows of the
// discovery protocol, repeated within their lease and whenever a program probes; request lines on
// asip/BOARD/in, what the board says on asip/BOARD/out; `online` and, as its will, `lost` on $state. It knows
// no models: commands as JSON, answers and proofs are for an agent.
#pragma once

#include "Mqtt.h"

class BusMember {
  public:
    // Takes the lines of a message for the board. False if there is no room for them.
    typedef bool (*LineTaker)(const uint8_t* text, uint16_t length);

    // The texts last as long as the member. `services` are the names of their models: "io", "servo".
    struct Names {
        const char* board;
        const char* const* services;
        uint8_t serviceCount;
    };

    BusMember(Client& client, const Names& names, LineTaker taker)
        : mqtt_(client, onMessage, this), names_(names), taker_(taker) {}

    // Connects, and connects again after 1 to 30 s; announces. Call in each loop, while there is a network.
    void poll(const char* broker, uint16_t port, uint32_t nowMs);

    // Publishes a line of the board, without its end. Lost while there is no broker.
    void publishLine(const char* line, uint16_t length);

    bool isOnline() const { return isOnline_; }
    unsigned long refused() const { return refused_; }  // messages without room, or retained

  private:
    static constexpr uint8_t kMaxTopic = 100;

    static void onMessage(void* owner, const char* topic, const uint8_t* payload, uint16_t length,
                          bool retained);
    void handle(const char* topic, const uint8_t* payload, uint16_t length, bool retained);
    void connect(const char* broker, uint16_t port, uint32_t nowMs);
    void goOnline(uint32_t nowMs);
    void announce(uint32_t nowMs);
    const char* topic(const char* before, const char* after);
    bool publishText(const char* topic, const char* text, bool retained);

    Mqtt mqtt_;
    Names names_;
    LineTaker taker_;
    char topic_[kMaxTopic];
    bool isOnline_ = false, isProbed_ = false, hasTried_ = false;
    uint32_t triedMs_ = 0, announcedMs_ = 0, waitMs_ = 0;
    unsigned long refused_ = 0;
};
