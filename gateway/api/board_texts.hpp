// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>

#include "asip/bus/registry/items.hpp"

namespace asip::gateway::api {

/// Boards as JSON texts. Making one costs much more than sending it: of a board that is asked for again only
/// its age is written anew, as long as nothing else of it changes. Boards say how long their texts are:
/// beyond max_bytes, which the last one may exceed, all are made again. Pure.
class BoardTexts {
  public:
    static constexpr std::size_t kMaxBoards = 500;
    static constexpr std::size_t kMaxBytes = std::size_t{16} << 20;

    explicit BoardTexts(std::size_t max_bytes = kMaxBytes) : max_bytes_(max_bytes) {}

    /// A JSON object: what bus::to_json() gives, in another order.
    std::string text(const bus::BoardItem& board);
    /// Of what is kept, about.
    std::size_t bytes() const { return bytes_; }

  private:
    struct Entry {
        bus::BoardItem board;
        std::string rest;  // the object behind its age
        std::size_t bytes = 0;
    };
    void make_room_for(const std::string& board);

    const std::size_t max_bytes_;
    std::map<std::string, Entry> entries_;
    std::size_t bytes_ = 0;
};

}  // namespace asip::gateway::api
