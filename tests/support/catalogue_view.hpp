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
/// without gap or duplicate. Subscribe to ROOT/registry/+/events, query boards page by page with
/// `next_query()`, and give all that arrives to `page` and `event`, in order. Pure.
/// Whenever `needs_snapshot()` becomes true (at first, after a lost event, a restart or a reset) query again
/// from the first page.
class CatalogueView {
  public:
    struct Change {
        ChangeEvent::Kind kind;
        BoardItem board;     ///< after the change
        std::string was;     ///< kState: the effective state before
        std::string reason;  ///< kState: why
    };
    /// For each change behind the first complete snapshot; after a new one, for each difference.
    using OnChange = std::function<void(const Change&)>;

    /// `pattern`: of names of boards; empty: all.
    explicit CatalogueView(OnChange on_change = {}, std::string pattern = {});

    /// Empty: the snapshot is complete and no event was lost. Ask again after each page.
    std::optional<Query> next_query() const;
    bool needs_snapshot() const { return next_query().has_value(); }
    /// Where to send the next page's query; empty before the first page.
    const std::string& registry() const { return registry_; }

    /// False: a refusal, or of another registry or epoch than the pages before: call restart().
    bool page(const Answer& answer);
    /// Events of other registries and those in a page are ignored.
    void event(const ChangeEvent& event);
    /// No answer in time, or the connection was lost. The boards stay until the new snapshot.
    void restart();

    /// boards() is a snapshot with all events since.
    bool complete() const { return complete_; }
    /// By name, without descriptions. page() and event() change it.
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
