// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/property/property.hpp"
#include "gateway/auth/rights.hpp"

namespace asip::gateway {

/// One thing that a dashboard shows; its board's list says what its property is.
struct Widget {
    enum class Kind { kValue, kPlot, kSwitch, kSlider, kLamp, kStop, kGauge, kText };

    std::string id;  ///< unique in its dashboard
    Kind kind = Kind::kValue;
    std::string title;            ///< empty: the name of the property
    std::string size;             ///< "small", "wide" or "large"; empty: "small"
    std::string board, property;  ///< of a stop and a text empty; `property`: its id
    std::string labels;           ///< in place of `board`: one of each board that has them, as `class=4b`
    std::string text;             ///< of a text
    std::string span;             ///< of a plot: "hour", "day", "week" or "month"; empty: the last minute

    static constexpr std::array<std::string_view, 4> kSpans{"hour", "day", "week", "month"};
    /// Zero: what a registry keeps is not shown at first.
    std::chrono::hours span_time() const;
    bool sends() const { return kind == Kind::kSwitch || kind == Kind::kSlider; }
    std::string_view service() const { return property::service_of(property); }
};

/// A link that shows a dashboard. Only the hash of its token is kept.
struct DashboardLink {
    std::string name;
    std::string hash;
    std::string by;     ///< the user who made it, with whose right it ends
    std::string maker;  ///< which token that was: Rights::mark(); empty: none, or an earlier version made it
    bool control = false;
    std::optional<text::WallTime> until;
};

/// As it is retained on the bus.
struct Dashboard {
    static constexpr std::size_t kMaxBytes = std::size_t{16} * 1024;  ///< of what a client sends
    static constexpr std::size_t kMaxKept = std::size_t{32} * 1024;   ///< of what is retained
    static constexpr std::size_t kMaxWidgets = 48;
    static constexpr std::size_t kMaxLinks = 16;
    static constexpr std::size_t kMaxTiles = 192;  ///< with those of labels

    std::string title;
    std::vector<Widget> widgets;
    std::vector<DashboardLink> links;
    std::string by, changed;  ///< the user who changed it last, and when

    const Widget* widget(std::string_view id) const;
    const DashboardLink* link(std::string_view name) const;
    /// In the order of the widgets.
    std::vector<std::string> boards() const;
    /// The rights show all of it; `name`: its own. A widget of labels may come to show any board.
    bool seen_by(const Rights& rights, std::string_view name) const;
};

/// A board's name that does not end in a topic of a service.
bool valid_dashboard_name(std::string_view name);
inline constexpr const char* kDashboardNameForm =
    "a dashboard's name is 1 to 64 of A-Z a-z 0-9 . _ -, and none of in, out, error and set";

/// From a client: `{"title":..,"widgets":[..]}`. Widgets without an id get one. The error names the place.
Expected<Dashboard> parse_dashboard(std::string_view text);
Expected<Dashboard> parse_kept_dashboard(std::string_view text);
/// What is retained; parse_kept_dashboard() reads it.
std::string kept_text(const Dashboard& dashboard);
/// For clients: without links.
nlohmann::json to_json(const Dashboard& dashboard);
/// Made of title and widgets: whatever an editor changes gives another one.
std::string etag_of(const Dashboard& dashboard);
/// What a client with this link may do.
Rights rights_of(const std::string& dashboard, const DashboardLink& link);

}  // namespace asip::gateway
