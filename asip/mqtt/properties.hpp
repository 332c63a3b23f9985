// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <mosquitto.h>

#include <memory>

#include "asip/mqtt/message.hpp"

/// MQTT 5 properties between our messages and libmosquitto.
namespace asip::mqtt {

struct FreeProperties {
    void operator()(mosquitto_property* list) const { mosquitto_property_free_all(&list); }
};
using Properties = std::unique_ptr<mosquitto_property, FreeProperties>;

/// Null: there is nothing to carry.
Properties publish_properties(const Message& message);

inline Properties will_properties(const Message& message) {
    return publish_properties(message);
}

/// Fills in the members that travel as properties. `list` may be null.
void read_properties(const mosquitto_property* list, Message& message);

}  // namespace asip::mqtt
