// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace asip::bus {

/// What can be read of a request that is no JSON, so that its sender gets the refusal.
struct BrokenRequest {
    /// An object: of `reply_to`, `id` and `by` what stands before the fault.
    nlohmann::json members = nlohmann::json::object();
    std::string error;  ///< a sentence for a person
};

/// A number that no computer can hold (`1e400`) is a fault that does not end the reading.
BrokenRequest read_broken_request(std::string text);

}  // namespace asip::bus
