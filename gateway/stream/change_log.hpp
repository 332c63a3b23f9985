// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "gateway/stream/feed.hpp"

namespace asip::gateway {

class ChangeFeed;

/// The last changes of the catalogue, for clients that follow it and clients that come back to it: as many
/// as fit into `max_bytes`, the oldest go first. Feeds refer to it and may outlive it: then they give nothing
/// more. Pure.
class ChangeLog {
  public:
    struct Change {
        std::uint64_t number = 0;
        std::string_view kind;  ///< bus::to_string(ChangeEvent::Kind), or "status"; of static storage
        std::string board;      ///< empty: not of one board
        std::string data;       ///< JSON object
    };

    explicit ChangeLog(std::string epoch, std::size_t max_bytes = std::size_t{8} << 20)
        : epoch_(std::move(epoch)), max_bytes_(max_bytes) {}
    ~ChangeLog();
    ChangeLog(const ChangeLog&) = delete;
    ChangeLog& operator=(const ChangeLog&) = delete;

    const std::string& epoch() const { return epoch_; }
    /// Number of the last change; 0: none yet.
    std::uint64_t last() const { return last_; }
    /// Numbers a change and wakes every feed. `kind`: of static storage.
    void add(std::string_view kind, std::string board, std::string data);
    /// Null: gone, or not yet there.
    const Change* change(std::uint64_t number) const;

  private:
    friend class ChangeFeed;

    std::string epoch_;
    std::size_t max_bytes_;
    std::size_t bytes_ = 0;
    std::uint64_t last_ = 0;
    std::deque<Change> changes_;
    std::vector<ChangeFeed*> feeds_;
};

}  // namespace asip::gateway
