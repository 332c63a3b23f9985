// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>

#include "asip/bus/items.hpp"

namespace asip::gateway::api {

/// Boards as JSON texts. Making one costs much more than sending it: of a board that is asked for again only
/// its age is written anew, as long as nothing else of it changes. Pure.
class BoardTexts {
  public:
    static constexpr std::size_t kMaxBoards = 500;

    /// A JSON object: what bus::to_json() gives, in another order.
    std::string text(const bus::BoardItem& board);

  private:
    struct Entry {
        bus::BoardItem board;
        std::string rest;  // the object behind its age
    };
    std::map<std::string, Entry> entries_;
};

}  // namespace asip::gateway::api
