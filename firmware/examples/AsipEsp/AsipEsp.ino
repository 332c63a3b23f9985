// SPDX-License-Identifier: Apache-2.0
// A board with a network, an ESP8266 or ESP32: its pins over TCP (port 5507) and on the ASIP bus, with no computer in
// between. Fill in your network and your broker. What was tried of it where: README.md beside this file.
#include <Asip.h>
#ifdef ESP8266
#include <ESP8266WiFi.h>
#else
#include <WiFi.h>
#endif

#include "BusMember.h"
#include "NetworkLine.h"
#include "NewestClient.h"

static const char* const kNetwork = "your network";
static const char* const kPassword = "its password";
static const char* const kBroker = "192.168.1.2";
static const uint16_t kBrokerPort = 1883;
static const char* const kServices[] = {"io"};

WiFiServer server(5507);
NewestClient<WiFiClient> tcp;
WiFiClient brokerConnection;
BusMember member(brokerConnection, {"esp1", kServices, 1}, networkLine::giveLines);

void sendLine(const char* line, uint16_t length) {
    tcp.write(line, length + 1);  // and its end
    member.publishLine(line, length);
}

void setup() {
    WiFi.mode(WIFI_STA);
    WiFi.begin(kNetwork, kPassword);  // and comes back by itself
    networkLine::sink = sendLine;
    asip::board.begin(ASIP_NAME("AsipEsp"));
    server.begin();
}

void loop() {
    const uint32_t now = millis();
    if (WiFi.status() == WL_CONNECTED) {
        WiFiClient next = server.available();
        if (next) tcp.take(next, now);
        tcp.poll(networkLine::give, now);
        member.poll(kBroker, kBrokerPort, now);
    }
    asip::board.run();
}
