// SPDX-License-Identifier: Apache-2.0
// As much of MQTT 3.1.1 as a bare member of the bus needs: one connection with a will, messages of quality 0.
// Nothing here waits for the broker but the opening of the connection, which the Arduino core's client waits
// for.
#pragma once

#include <Arduino.h>
#include <Client.h>

class Mqtt {
  public:
    // What came on a topic that was subscribed to. `topic` ends in '\0'; both last for the call.
    typedef void (*Handler)(void* owner, const char* topic, const uint8_t* payload, uint16_t length,
                            bool retained);

    // Longer packets from the broker are skipped, and longer ones are not sent.
    static constexpr uint16_t kMaxPacket = 512;

    Mqtt(Client& client, Handler handler, void* owner) : client_(client), handler_(handler), owner_(owner) {}

    // Opens a connection. False if no broker is there, or if the texts are too long for a packet.
    bool open(const char* host, uint16_t port, const char* clientId, const char* willTopic, const char* will,
              uint32_t nowMs);

    // Takes what came, and keeps the connection alive. Call often.
    void poll(uint32_t nowMs);

    bool isOpen() const { return state_ != kClosed; }
    bool isAccepted() const { return state_ == kAccepted; }

    // False if it could not be sent.
    bool publish(const char* topic, const uint8_t* payload, uint16_t length, bool retained);
    bool subscribe(const char* topic);

    // Ends the connection; the broker publishes the will.
    void drop();

  private:
    enum State : uint8_t { kClosed, kConnecting, kAccepted };

    void take(uint8_t byte);
    void handlePacket();
    bool appendText(const char* text);
    bool send(uint8_t type, uint16_t length);

    Client& client_;
    Handler handler_;
    void* owner_;
    State state_ = kClosed;

    // The packet that is being received: its first byte, its length as far as that is known, its content.
    uint8_t type_ = 0;
    uint8_t lengthBytes_ = 0;
    uint32_t length_ = 0;
    uint32_t received_ = 0;
    bool inContent_ = false;
    uint8_t in_[kMaxPacket];

    uint8_t out_[kMaxPacket];
    uint16_t used_ = 0;
    uint32_t heardMs_ = 0, pingedMs_ = 0;
};
