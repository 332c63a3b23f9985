// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gateway/stream/budget.hpp"
#include "gateway/stream/feed.hpp"

namespace asip::gateway {

class ChangeFeed;

/// The last changes of the catalogue, as many as fit into `max_bytes`. Feeds may outlive it: then they end.
/// Pure.
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
    /// 0: none yet.
    std::uint64_t last() const { return last_; }
    /// Wakes every feed. `kind`: of static storage.
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

/// Each board that matches (`board`), `snapshot-end`, then each change: what changes during the snapshot is
/// in it or follows, once. A filtered feed sends `bookmark` events, to be resumed after a quiet time. One
/// that is too slow is sent `reset` and begins anew.
class ChangeFeed : public Feed {
  public:
    static constexpr std::uint64_t kBookmarkAfter = 100;  ///< changes that did not match
    static constexpr Duration kBookmarkTime = std::chrono::seconds(15);

    /// Boards behind `after` by name, as many as others can wait for.
    struct Page {
        std::vector<std::string> boards;  ///< JSON objects, without those that the reader may not see
        std::string behind;               ///< the last name that was looked at
        bool last = true;
    };
    using ReadPage =
        std::function<Page(const std::string& pattern, const std::string& after, const Instant&)>;
    using Allowed = std::function<bool(std::string_view board)>;

    struct Options {
        std::string board = "*";     ///< pattern
        std::optional<Place> after;  ///< resume behind it; where it is gone, `reset` and the state follow
        bool snapshot = true;        ///< false: only what changes from now on
        Allowed allowed;             ///< which changes the reader may see; empty: all
        Budget::Part part{};         ///< of the reader: for what waits here to be sent
    };

    /// `read_page` is called once a turn, and leaves out what the reader may not see.
    ChangeFeed(ChangeLog& log, ReadPage read_page, Options options);
    ~ChangeFeed() override;

    bool next(StreamEvent& event, const Instant& now) override;
    void tick(const Instant& now) override;
    bool more() const override { return phase_ == Phase::kSnapshot && turn_over_ && fault_.empty(); }
    std::string_view fault() const override { return fault_; }

  private:
    friend class ChangeLog;
    enum class Phase { kReset, kSnapshot, kLive };

    bool matches(const ChangeLog::Change& change) const;
    bool in_snapshot(const ChangeLog::Change& change) const;
    bool next_board(StreamEvent& event, const Instant& now);
    bool next_change(StreamEvent& event, const Instant& now);
    bool bookmark(StreamEvent& event, const Instant& now);
    void begin_snapshot();
    bool read_page(const Instant& now);

    ChangeLog* log_;
    ReadPage read_page_;
    std::string pattern_;
    Allowed allowed_;
    Budget::Part part_;
    std::string_view fault_;
    Phase phase_ = Phase::kLive;
    std::string_view reset_reason_;
    std::uint64_t sent_ = 0;    // everything up to here is with the reader, or does not concern it
    std::uint64_t placed_ = 0;  // number of the last place that the reader was given
    bool bookmark_due_ = false;
    Time quiet_since_{};
    Page page_;
    std::size_t at_ = 0;      // in page_
    bool turn_over_ = false;  // the next page is read in another turn
    std::string last_name_;
    std::vector<std::pair<std::string, std::uint64_t>> pages_;  // last name of each, and the change it holds
};

}  // namespace asip::gateway
