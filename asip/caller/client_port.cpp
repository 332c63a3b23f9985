// SPDX-License-Identifier: Apache-2.0
#include "asip/caller/client_port.hpp"

#include <utility>

namespace asip::caller {

Caller::Port port_of(mqtt::Client& client) {
    Caller::Port port;
    port.publish = [&client](mqtt::Message message) {
        return client.publish(std::move(message), mqtt::Priority::kReply) != mqtt::PublishResult::kRefused;
    };
    port.subscribe = [&client](const std::string& filter, mqtt::SubscribeOptions options) {
        client.subscribe(filter, options);
    };
    port.unsubscribe = [&client](const std::string& filter) { client.unsubscribe(filter); };
    port.v5 = [&client] { return client.v5(); };
    port.unacknowledged = [&client] { return client.counters().unacknowledged; };
    return port;
}

}  // namespace asip::caller
