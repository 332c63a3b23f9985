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

// Bounds of a demand; one that goes beyond is refused.
inline constexpr std::size_t kMaxDemandBytes = 4096;
inline constexpr std::size_t kMaxDemandedServices = 32;
inline constexpr std::chrono::seconds kMaxDemandLease{300};
inline constexpr std::chrono::seconds kDemandLease{15};

/// Values a second of a demand that does not say how many.
inline constexpr double kUsualHz = 10;

/// The values of one board that a program wants, as long as the lease runs: a message on
/// ROOT/servicebus/BOARD/$demand/USER/CLIENT. It replaces the one before from there.
struct Demand {
    /// Names of services, patterns allowed (`*`, `?`), and how many values a second are enough, above 0.
    /// Empty: nothing is wanted any more.
    std::map<std::string, double> services;
    std::chrono::seconds lease = kDemandLease;  ///< 1 s to kMaxDemandLease
    /// Where the agent is to answer with the values that it knows now, of `services` and `asked`;
    /// empty: nowhere. An agent answers below ROOT/reply/USER/BOARD/ alone.
    std::string reply_to{};
    std::string id{};
    std::vector<std::string> asked{};  ///< those of `services` with 0 values a second
    bool list = false;                 ///< the answer is to have the properties, too

    friend bool operator==(const Demand&, const Demand&) = default;
};

/// Whether some service can have this name, or match this pattern.
bool can_be_demanded(std::string service);

/// {"services":{"distance":20},"lease":15,"reply_to":"asip/reply/ann/uno1/c1","id":"7"}
std::string to_text(const Demand& demand);

/// From a payload that anyone may have published. Services with 0 are left out; unknown members are passed
/// over. Fails with the first fault and its place: not JSON, `services` missing or not an object, more than
/// kMaxDemandedServices, a name that no service can have, a number below 0, another lease.
Expected<Demand> parse_demand(std::string_view text);

}  // namespace asip::bus
