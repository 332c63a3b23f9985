// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::bus {

// Larger demands are refused.
inline constexpr std::size_t kMaxDemandBytes = 4096;
inline constexpr std::size_t kMaxDemandedServices = 32;
inline constexpr std::chrono::seconds kMaxDemandLease{300};
inline constexpr std::chrono::seconds kDemandLease{15};

/// Values a second, where a demand does not say.
inline constexpr double kUsualHz = 10;

/// The values of a board that a program wants while the lease runs:
/// ROOT/servicebus/BOARD/$demand/USER/CLIENT. It replaces the one before.
struct Demand {
    /// Names of services or patterns (`*`, `?`), and values a second, above 0. Empty: nothing is wanted.
    std::map<std::string, double> services;
    std::chrono::seconds lease = kDemandLease;  ///< 1 s to kMaxDemandLease
    /// Where the agent answers with the values of `services` and `asked`, below ROOT/reply/USER/BOARD/ alone;
    /// empty: nowhere.
    std::string reply_to{};
    std::string id{};
    std::vector<std::string> asked{};  ///< those of `services` with 0 values a second
    bool list = false;                 ///< the answer is to have the properties, too

    friend bool operator==(const Demand&, const Demand&) = default;
};

/// Some service can have this name, or match this pattern.
bool can_be_demanded(std::string service);

/// {"services":{"distance":20},"lease":15,"reply_to":"asip/reply/ann/uno1/c1","id":"7"}
std::string to_text(const Demand& demand);

/// From a payload of anyone. Services with 0 are left out, unknown members passed over. Fails with the first
/// fault and its place.
Expected<Demand> parse_demand(std::string_view text);

}  // namespace asip::bus
