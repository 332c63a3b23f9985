#pragma once
#include <functional>
#include <string>

#include "asip/mqtt/message.hpp"

namespace asip::registry {

/// What the parts of a registry ask of the connection; tests take its place.
struct BusPort {
    std::function<void(mqtt::Message)> publish;
    /// `retained`: deliver stored ones, too.
    std::function<void(std::string filter, bool retained)> subscribe;
    std::function<void(const std::string& filter)> unsubscribe;
};

}  // namespace asip::registry
