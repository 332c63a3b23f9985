// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

namespace asip::gateway {

/// How it stands with another system that boards can be shown to.
struct ExportStanding {
    std::string system;  ///< as `asip-gateway export` calls it
    std::string title;   ///< "Home Assistant"
    bool on = false;     ///< this gateway has the option
    bool shows = false;  ///< it shows boards there now
    std::string other;   ///< the machine of another gateway that does; empty: none
    /// What the system last said of itself: it is there, or has left. Nothing: it said nothing yet, or never
    /// does.
    std::optional<bool> found;
};

}  // namespace asip::gateway
