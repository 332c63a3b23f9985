// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace asip::bus {

/// A request that is no JSON, so that its sender gets the refusal.
struct BrokenRequest {
    /// Those of `reply_to`, `id` and `by` that stand before the fault.
    nlohmann::json members = nlohmann::json::object();
    std::string error;  ///< a sentence for a person
};

/// An impossible number (`1e400`) does not end the reading.
BrokenRequest read_broken_request(std::string text);

}  // namespace asip::bus
