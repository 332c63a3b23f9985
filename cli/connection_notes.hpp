// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cli/bus_session.hpp"

namespace asip::cli {

/// From now on the user is told when the connection is lost and when it is back: for who listens for long.
/// `context` outlives the session.
inline void tell_connection(BusSession& session, const Context& context) {
    session.on_connection_change([&context](bool connected, const std::string& why) {
        context.note(connected ? "connected again" : why);
    });
}

}  // namespace asip::cli
