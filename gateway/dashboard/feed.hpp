// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gateway/dashboard/dashboards.hpp"
#include "gateway/mirror/mirror.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway {

/// One dashboard, live: the document (`dashboard`), the state of each of its boards (`board`), and of each
/// widget what it shows (`widget`; of a plot first `past`), then `snapshot-end` and the changes. Nothing else
/// of the boards is in it. A dashboard that changes begins anew; one that is removed, or that its reader may
/// not see any more, is `gone`. Pure.
class DashboardFeed final : public Feed {
  public:
    static constexpr std::size_t kBytes = 4 * 1024;
    static constexpr std::size_t kMaxPast = 600;  ///< points of a plot

    struct Options {
        std::string name;
        Rights rights;
        double max_hz = 10;
        /// Makes a board report while the returned value lives.
        std::function<std::shared_ptr<void>(const std::string& board, const std::string& service)> demand;
        std::function<Budget::Part()> part;  ///< of the reader
    };

    DashboardFeed(const Dashboards& dashboards, Mirror& mirror, Options options, const Instant& now);
    ~DashboardFeed() override;

    bool next(StreamEvent& event, const Instant& now) override;
    void tick(const Instant& now) override;
    std::string_view fault() const override { return fault_; }

  private:
    struct Source {
        std::string board, service;
        std::unique_ptr<ValueFeed> feed;
        bool ended = false;  // its snapshot
    };
    void begin(const Instant& now);
    void end();
    void add_sources();
    void add_past(const Widget& widget);
    void show_boards(const Instant& now);
    void read(Source& source, const StreamEvent& event);
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
    std::string etag_;
    Dashboard dashboard_;
    std::map<std::string, std::string> board_texts_;  // as they were told
    std::vector<Source> sources_;
    std::deque<StreamEvent> out_;
};

}  // namespace asip::gateway
