// SPDX-License-Identifier: Apache-2.0
#include "Mqtt.h"

#include <string.h>

// Types of packets, in the first byte (MQTT 3.1.1, section 2.2).
static constexpr uint8_t kConnect = 0x10, kConnected = 0x20, kPublish = 0x30, kSubscribe = 0x82, kPing = 0xC0;
static constexpr uint8_t kRetained = 0x01, kQualityBits = 0x06;
static constexpr uint8_t kWithRetainedWill = 0x26;  // clean session, will, will retained
static constexpr uint16_t kKeepAliveSeconds = 30;
static constexpr uint32_t kPingMs = 10000, kSilenceMs = 45000;

bool Mqtt::open(const char* host, uint16_t port, const char* clientId, const char* willTopic,
                const char* will, uint32_t nowMs) {
    drop();
    if (!client_.connect(host, port)) return false;
    used_ = 0;
    const uint8_t head[] = {0, 4, 'M', 'Q', 'T', 'T', 4, kWithRetainedWill, 0, kKeepAliveSeconds};
    memcpy(out_, head, sizeof head);
    used_ = sizeof head;
    if (!appendText(clientId) || !appendText(willTopic) || !appendText(will) || !send(kConnect, used_)) {
        drop();
        return false;
    }
    state_ = kConnecting;
    inContent_ = false;
    lengthBytes_ = 0;
    type_ = 0;
    heardMs_ = pingedMs_ = nowMs;
    return true;
}

void Mqtt::drop() {
    client_.stop();
    state_ = kClosed;
}

void Mqtt::poll(uint32_t nowMs) {
    if (state_ == kClosed) return;
    while (state_ != kClosed && client_.available() > 0) {
        heardMs_ = nowMs;
        take(static_cast<uint8_t>(client_.read()));
    }
    if (state_ == kClosed) return;
    if (!client_.connected() || nowMs - heardMs_ >= kSilenceMs) return drop();
    if (state_ == kAccepted && nowMs - pingedMs_ >= kPingMs) {
        pingedMs_ = nowMs;
        if (!send(kPing, 0)) drop();
    }
}

void Mqtt::take(uint8_t byte) {
    if (type_ == 0) {
        type_ = byte;
        length_ = received_ = 0;
        lengthBytes_ = 0;
        inContent_ = false;
        return;
    }
    if (!inContent_) {
        length_ |= static_cast<uint32_t>(byte & 0x7F) << (7 * lengthBytes_);
        if (byte & 0x80) {
            if (++lengthBytes_ > 3) drop();
            return;
        }
        inContent_ = true;
    } else {
        if (received_ < kMaxPacket) in_[received_] = byte;
        ++received_;
    }
    if (received_ < length_) return;
    if (length_ <= kMaxPacket) handlePacket();
    type_ = 0;
}

void Mqtt::handlePacket() {
    if (type_ == kConnected) {
        if (length_ != 2 || in_[1] != 0) return drop();
        state_ = kAccepted;
        return;
    }
    if ((type_ & 0xF0) != kPublish || (type_ & kQualityBits) != 0 || length_ < 2) return;
    const uint16_t topicLength = static_cast<uint16_t>(in_[0] << 8 | in_[1]);
    if (topicLength + 2u > length_) return drop();
    // The topic moves over its length, to make room for its end.
    memmove(in_, in_ + 2, topicLength);
    in_[topicLength] = '\0';
    handler_(owner_, reinterpret_cast<const char*>(in_), in_ + 2 + topicLength,
             static_cast<uint16_t>(length_ - 2 - topicLength), type_ & kRetained);
}

bool Mqtt::appendText(const char* text) {
    const size_t length = strlen(text);
    if (used_ + 2 + length > kMaxPacket) return false;
    out_[used_++] = static_cast<uint8_t>(length >> 8);
    out_[used_++] = static_cast<uint8_t>(length);
    memcpy(out_ + used_, text, length);
    used_ = static_cast<uint16_t>(used_ + length);
    return true;
}

// In one piece where the client can: a packet in two segments waits for an acknowledgement.
bool Mqtt::send(uint8_t type, uint16_t length) {
    uint8_t packet[3 + kMaxPacket];
    uint8_t head = 0;
    packet[head++] = type;
    if (length > 127) packet[head++] = static_cast<uint8_t>(length | 0x80);
    packet[head++] = static_cast<uint8_t>(length > 127 ? length >> 7 : length);
    memcpy(packet + head, out_, length);
    return client_.write(packet, static_cast<size_t>(head + length)) == static_cast<size_t>(head + length);
}

bool Mqtt::publish(const char* topic, const uint8_t* payload, uint16_t length, bool retained) {
    used_ = 0;
    if (state_ != kAccepted || !appendText(topic) || used_ + length > kMaxPacket) return false;
    memcpy(out_ + used_, payload, length);
    return send(retained ? kPublish | kRetained : kPublish, static_cast<uint16_t>(used_ + length));
}

bool Mqtt::subscribe(const char* topic) {
    used_ = 0;
    out_[used_++] = 0;
    out_[used_++] = 1;  // number of the packet
    if (state_ != kAccepted || !appendText(topic) || used_ == kMaxPacket) return false;
    out_[used_++] = 0;  // quality
    return send(kSubscribe, used_);
}
