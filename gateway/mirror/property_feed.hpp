// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <set>
#include <string>

#include "gateway/export/exported_board.hpp"
#include "gateway/mirror/mirror.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway {

/// A document as agents publish it (docs/service-bus.md), by `choose`.
std::string values_text(Mirror& mirror, const exports::ExportedBoard& board, const std::string& session,
                        const std::function<bool(const property::Property&)>& choose, const Instant& now);

/// The newest first: [["2026-01-31T12:00:00.000Z", 42], ...], at most `max`; nothing for sums, and without
/// reports.
nlohmann::json past_of(Mirror& mirror, const std::string& board, const property::Property& property,
                       std::size_t max);

/// How the properties of a board stand: `values` with all of them, `snapshot-end`, then `values` with those
/// that changed, each by its id. When the list changes, `properties` says so, and all follow again. Pure.
class PropertyFeed final : public Feed {
  public:
    static constexpr std::size_t kBytes = 4 * 1024;

    /// A board with the properties that the reader sees, and its session. Null: it is not there.
    struct Seen {
        std::string session;
        std::shared_ptr<const exports::ExportedBoard> board;
    };
    struct Options {
        std::string board;
        std::set<std::string> ids{};  ///< of properties; empty: all
        std::function<Seen(const Instant& now)> find;
        ValueFeed::Options values;  ///< which reports wake it
        Budget::Part part{};
    };
    PropertyFeed(Mirror& mirror, Options options);

    bool next(StreamEvent& event, const Instant& now) override;
    void tick(const Instant& now) override { reports_.tick(now); }
    std::string_view fault() const override { return fault_.empty() ? reports_.fault() : fault_; }

  private:
    bool is_wanted(const property::Property& property) const {
        return options_.ids.empty() || options_.ids.contains(property.id);
    }
    void read_report(const StreamEvent& event);

    Mirror& mirror_;
    Options options_;
    ValueFeed reports_;
    std::shared_ptr<void> told_;
    std::string_view fault_;
    Seen seen_;
    bool begins_ = true, lists_ = false, ended_ = false, live_ = false;
    std::set<std::string, std::less<>> changed_;  // ids
};

}  // namespace asip::gateway
