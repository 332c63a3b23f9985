// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "asip/property/property.hpp"
#include "cli/ask/bus_session.hpp"

namespace asip::cli {

/// The properties of boards, by their descriptions.
class DescribedProperties {
  public:
    static const std::vector<property::Property> kNone;

    /// Both must outlive it.
    DescribedProperties(BusSession& session, const Environment& environment)
        : session_(session), environment_(environment) {}

    /// By the newest description. It is asked for when a board is named first, so there are none until it
    /// came.
    const std::vector<property::Property>& of(const std::string& board);

  private:
    struct Known {
        std::pair<std::string, std::uint64_t> by{};  ///< session and number of the description
        std::vector<property::Property> properties{};
    };
    BusSession& session_;
    const Environment& environment_;
    std::map<std::string, Known> known_;
};

}  // namespace asip::cli
