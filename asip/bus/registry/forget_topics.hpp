// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "asip/bus/topics.hpp"

namespace asip::bus {

/// Where a registry, or each of them, is asked to forget a board: another topic than for queries, so that the
/// broker's access rules can let a user ask and not forget.
inline std::string forget_topic(const Topics& topics, std::string_view registry = {}) {
    return topics.root() + "/registry/" + (registry.empty() ? "" : std::string(registry) + "/") + "forget";
}

}  // namespace asip::bus
