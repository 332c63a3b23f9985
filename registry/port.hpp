// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <string>

#include "asip/mqtt/message.hpp"

namespace asip::registry {

/// What the parts of a registry ask of its connection.
struct Port {
    std::function<void(mqtt::Message)> publish;
    /// An answer, which must not wait behind what is told of changes. Empty: as publish().
    std::function<void(mqtt::Message)> answer{};
    /// Few answers wait for the broker; otherwise questions wait here.
    std::function<bool()> takes_answers = [] { return true; };
    /// `retained`: deliver stored messages, too.
    std::function<void(std::string filter, bool retained)> subscribe;
    std::function<void(const std::string& filter)> unsubscribe;
    /// Both for values that are kept, over a connection of their own: see Registry::values_lost(). Empty: as
    /// above.
    std::function<void(std::string filter, bool retained)> subscribe_values{};
    std::function<void(const std::string& filter)> unsubscribe_values{};
    /// Messages that wait for the broker.
    std::function<std::size_t()> queued = [] { return std::size_t{0}; };
};

}  // namespace asip::registry
