// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/bus/topics.hpp"
#include "asip/session/board_session.hpp"
#include "asip/session/service_table.hpp"

namespace asip::agent {

/// The one board of an agent, as all its rooms share it. The bridge owns it and changes name and services;
/// the rooms hold references, and may submit requests to the session.
struct Board {
    bus::Topics topics;
    session::BoardSession session;
    std::string name{};                ///< on the bus; empty until the board was identified
    session::ServiceTable services{};  ///< of the board that was identified last
};

}  // namespace asip::agent
