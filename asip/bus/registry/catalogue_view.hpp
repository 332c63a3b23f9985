// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"

namespace asip::bus {

/// A watcher's copy of a registry's boards: joins the pages of a snapshot to the stream of change events,
/// with no gap and no duplicate. How to use it: subscribe to ROOT/registry/+/events, then query boards page
/// by page (sort by name, no filter but `board`), and give everything that arrives to `page` and `event`, in
/// the order it arrives. Each page is true for its own sequence number; the view knows which events are
/// already in it.
///
/// Pure: the caller sends the queries. Whenever `needs_snapshot()` becomes true (at first, after a lost
/// event, when the registry restarted or sent a reset) the caller queries again from the first page, with
/// `next_query()`.
class CatalogueView {
  public:
    /// What happened to one board, as in ChangeEvent.
    struct Change {
        ChangeEvent::Kind kind;
        BoardItem board;     ///< after the change
        std::string was;     ///< kState: the effective state before
        std::string reason;  ///< kState: why
    };
    /// Called for each change once the first snapshot is complete; after a new snapshot, for what differs
    /// from before.
    using OnChange = std::function<void(const Change&)>;

    /// `pattern`: only boards whose names match it; empty: all.
    explicit CatalogueView(OnChange on_change = {}, std::string pattern = {});

    /// The query to send now; empty while there is nothing to ask (the snapshot is complete and no event was
    /// lost). Each page given changes it; ask again after each page.
    std::optional<Query> next_query() const;
    bool needs_snapshot() const { return next_query().has_value(); }
    /// Registry that the snapshot comes from, to send the next page's query to; empty before the first page.
    const std::string& registry() const { return registry_; }

    /// Takes the answer to next_query(). False if it is refused, of another registry or of another epoch than
    /// the pages before it: then call restart() and begin again.
    bool page(const Answer& answer);
    /// Events of other registries and those already in a page are ignored.
    void event(const ChangeEvent& event);
    /// Begins anew (no answer in time, connection lost); the boards stay until the new snapshot replaces
    /// them.
    void restart();

    /// Whether boards() is a whole snapshot with every event since applied.
    bool complete() const { return complete_; }
    /// In the order of their names; without descriptions. Changed by page() and event().
    const std::map<std::string, BoardItem>& boards() const { return boards_; }

  private:
    void apply(const ChangeEvent& event);
    void finish_snapshot();
    void notify(ChangeEvent::Kind kind, const BoardItem& board, std::string was, std::string reason);

    OnChange on_change_;
    std::string pattern_;
    std::string registry_;
    std::string epoch_;
    std::string cursor_;
    std::uint64_t seq_ = 0;   // last event applied or known to be in every page
    bool complete_ = false;   // boards_ is a whole snapshot plus the events after it
    bool collecting_ = true;  // between first and last page
    std::map<std::string, BoardItem> boards_;
    std::map<std::string, BoardItem> incoming_;
    std::map<std::string, std::uint64_t> page_ends_;  // last name of each page -> its sequence number
    std::vector<ChangeEvent> waiting_;                // arrived while collecting, in that order
};

}  // namespace asip::bus
