// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "gateway/dashboard/dashboards.hpp"
#include "gateway/mirror/mirror.hpp"
#include "gateway/mirror/property_feed.hpp"

namespace asip::gateway {

/// With a widget for each board that has the labels of one; its id is `ID.BOARD`.
Dashboard with_boards(Dashboard dashboard, Mirror& mirror, const Instant& now);

/// One dashboard, live: the document (`dashboard`), the state of each board (`board`), of each widget its
/// property (`property`) and value (`widget`; of a plot first `past`), `snapshot-end` and the changes. After
/// a change it begins anew; one that is removed, or hidden from its reader, is `gone`. Pure.
class DashboardFeed final : public Feed {
  public:
    static constexpr std::size_t kBytes = 4 * 1024;
    static constexpr std::size_t kMaxPast = 600;  ///< points of a plot

    struct Options {
        std::string name;
        Rights rights;
        double max_hz = 10;
        /// For these properties of a board, by id.
        std::function<PropertyFeed::Options(const std::string& board, const std::set<std::string>& ids)>
            properties;
        std::function<Budget::Part()> part;  ///< of the reader
    };

    DashboardFeed(const Dashboards& dashboards, Mirror& mirror, Options options, const Instant& now);
    ~DashboardFeed() override;

    bool next(StreamEvent& event, const Instant& now) override;
    void tick(const Instant& now) override;
    std::string_view fault() const override { return fault_; }

  private:
    struct Source {
        std::string board;
        std::function<PropertyFeed::Seen(const Instant& now)> find;
        std::unique_ptr<PropertyFeed> feed;
        bool ended = false;  // its snapshot
    };
    void begin(const Instant& now);
    void end();
    void add_sources(const Instant& now);
    void show_properties(const Source& source, const Instant& now);
    void show_boards(const Instant& now);
    void read(Source& source, const StreamEvent& event, const Instant& now);
    void put(std::string_view kind, const nlohmann::json& data);

    const Dashboards& dashboards_;
    Mirror& mirror_;
    Options options_;
    Budget::Part part_;
    std::string_view fault_;
    bool shown_ = false;  // there is a dashboard, and it may be seen
    bool gone_told_ = false;
    bool snapshot_over_ = false;
    std::uint64_t version_ = ~std::uint64_t{0};
    std::uint64_t changes_ = ~std::uint64_t{0};  // of the mirror
    std::string etag_, tiles_etag_;
    Time looked_{};                                   // for boards that came to have labels, or lost them
    Dashboard dashboard_;                             // with_boards()
    std::map<std::string, std::string> board_texts_;  // as they were told
    std::vector<Source> sources_;
    std::deque<StreamEvent> out_;
};

}  // namespace asip::gateway
