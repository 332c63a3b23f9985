// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "asip/bus/registry/answer.hpp"
#include "asip/caller/caller.hpp"
#include "gateway/auth/rights.hpp"
#include "gateway/export/exported_board.hpp"
#include "gateway/mirror/mirror.hpp"
#include "gateway/stream/feed.hpp"

namespace asip::gateway::api {

/// What is seen with these rights, for queries of the catalogue. Holds a copy of what it needs.
catalogue::View view_of(const Rights& rights);
/// The same for one board; empty: every board.
ChangeFeed::Allowed boards_of(const Rights& rights);

/// Takes out of a board that is seen what is not: services, their names, and pins where the service of pins
/// is hidden; also of its description.
void limit_to(const Rights& rights, bus::BoardItem& board);
/// A board with the properties that are seen. `board` may be null.
std::shared_ptr<const exports::ExportedBoard> seen(const Rights& rights,
                                                   std::shared_ptr<const exports::ExportedBoard> board);
/// The same for each board of a page of the catalogue.
void limit_to(const Rights& rights, bus::Answer& answer);
/// Whether an item of a history is seen.
bool sees(const Rights& rights, const bus::HistoryItem& item);

/// limit_to() for the boards in the events of a feed of the catalogue.
std::unique_ptr<Feed> limited_feed(std::unique_ptr<Feed> feed, const Rights& rights);

/// Demands values of what a stream shows, of boards that report on demand: of a limited token no more than
/// what it may read. Names may be patterns.
/// `count`: set to how many wants that is.
bus::Demander::Want demand_within(const Rights& rights, caller::Caller& caller, const std::string& board,
                                  const std::string& service, double hz, std::size_t& count);

}  // namespace asip::gateway::api
