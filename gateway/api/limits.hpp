// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "asip/bus/answer.hpp"
#include "asip/bus/demander.hpp"
#include "gateway/auth/rights.hpp"
#include "gateway/stream/feed.hpp"

namespace asip::gateway::api {

/// Takes out what a limited token does not show: boards, and services of boards and of their descriptions.
void limit_to(const Rights& rights, bus::Answer& answer);
void limit_to(const Rights& rights, bus::BoardItem& board);

/// The same for the boards in the events of a feed of the catalogue.
std::unique_ptr<Feed> limited_feed(std::unique_ptr<Feed> feed, const Rights& rights);

/// Demands values of what a stream shows, of boards that report on demand: of a limited token no more than
/// what it may read. Names may be patterns.
bus::Demander::Want demand_within(const Rights& rights, bus::Demander& demander, const std::string& board,
                                  const std::string& service, double hz);

}  // namespace asip::gateway::api
