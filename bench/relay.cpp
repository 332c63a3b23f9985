// SPDX-License-Identifier: Apache-2.0
// Repeats each message of one topic on another, and does nothing else: what a value on a second topic costs
// at least.
#include <cstdint>
#include <cstdlib>

#include "bench/mqtt_client.hpp"

int main(int count, char** words) {
    if (count != 4) return 2;  // PORT FROM TO
    asip::bench::MqttClient client(static_cast<std::uint16_t>(std::atoi(words[1])));
    client.subscribe(words[2]);
    for (;;) {
        if (!client.wait(std::chrono::hours(1))) continue;
        for (const auto& [topic, payload] : client.take())
            client.publish(words[3], payload);
    }
}
