// SPDX-License-Identifier: Apache-2.0
#include "BusMember.h"

#include <stdio.h>
#include <string.h>

static const char kRows[] = "asip/servicebus";
static const char kProbe[] = "asip/servicebus/$probe";

static constexpr uint32_t kAnnounceMs = 20000;  // a third of a lease
static constexpr uint32_t kProbeMs = 500;       // at most twice a second, however many ask
static constexpr uint32_t kFirstWaitMs = 1000, kLongestWaitMs = 30000;

// "BEFORE/BOARD" and AFTER. Empty, and so refused by the broker's rules, if it is too long.
const char* BusMember::topic(const char* before, const char* after) {
    const int length = snprintf(topic_, sizeof topic_, "%s/%s%s", before, names_.board, after);
    if (length < 0 || length >= kMaxTopic) topic_[0] = '\0';
    return topic_;
}

void BusMember::poll(const char* broker, uint16_t port, uint32_t nowMs) {
    mqtt_.poll(nowMs);
    if (!mqtt_.isOpen()) {
        isOnline_ = false;
        if (!hasTried_ || nowMs - triedMs_ >= waitMs_) connect(broker, port, nowMs);
        return;
    }
    if (!mqtt_.isAccepted()) return;
    if (!isOnline_) return goOnline(nowMs);
    if (nowMs - announcedMs_ >= (isProbed_ ? kProbeMs : kAnnounceMs)) announce(nowMs);
}

void BusMember::connect(const char* broker, uint16_t port, uint32_t nowMs) {
    waitMs_ = !hasTried_ || waitMs_ == 0     ? kFirstWaitMs
              : waitMs_ * 2 > kLongestWaitMs ? kLongestWaitMs
                                             : waitMs_ * 2;
    hasTried_ = true;
    triedMs_ = nowMs;
    mqtt_.open(broker, port, names_.board, topic(kRows, "/$state"), "lost", nowMs);
}

// Online means usable: the state comes behind the subscriptions.
void BusMember::goOnline(uint32_t nowMs) {
    if (!mqtt_.subscribe(topic("asip", "/in")) || !mqtt_.subscribe(kProbe) ||
        !publishText(topic(kRows, "/$state"), "online", true))
        return mqtt_.drop();
    isOnline_ = true;
    waitMs_ = 0;
    announce(nowMs);
}

void BusMember::announce(uint32_t nowMs) {
    isProbed_ = false;
    announcedMs_ = nowMs;
    bool sent = publishText(kRows, names_.board, false);
    for (uint8_t i = 0; i < names_.serviceCount && sent; ++i)
        sent = publishText(topic(kRows, ""), names_.services[i], false);
    if (!sent) mqtt_.drop();
}

bool BusMember::publishText(const char* to, const char* text, bool retained) {
    return mqtt_.publish(to, reinterpret_cast<const uint8_t*>(text), static_cast<uint16_t>(strlen(text)),
                         retained);
}

void BusMember::publishLine(const char* line, uint16_t length) {
    if (isOnline_)
        mqtt_.publish(topic("asip", "/out"), reinterpret_cast<const uint8_t*>(line), length, false);
}

void BusMember::onMessage(void* owner, const char* topic, const uint8_t* payload, uint16_t length,
                          bool retained) {
    static_cast<BusMember*>(owner)->handle(topic, payload, length, retained);
}

void BusMember::handle(const char* from, const uint8_t* payload, uint16_t length, bool retained) {
    if (strcmp(from, kProbe) == 0) {
        if (length == 0 || (length == strlen(names_.board) && memcmp(payload, names_.board, length) == 0))
            isProbed_ = true;
        return;
    }
    // A stored request is its sender's mistake: it would be executed at each connection.
    if (retained || !taker_(payload, length)) ++refused_;
}
