// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/bus/topics.hpp"
#include "asip/session/board_session.hpp"
#include "asip/session/service_table.hpp"

namespace asip::agent {

/// The board of an agent, shared by its rooms. Only the bridge changes name and services; all may submit
/// requests.
struct Board {
    bus::Topics topics;
    session::BoardSession session;
    std::string name{};                ///< on the bus; empty until the board was identified
    session::ServiceTable services{};  ///< of the board that was identified last
};

}  // namespace asip::agent
