// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "gateway/auth/rights.hpp"

namespace asip::gateway {

/// One thing that a dashboard shows. Which members count is `kind`'s to say.
struct Widget {
    enum class Kind { kValue, kPlot, kSwitch, kSlider, kLamp, kStop };

    std::string id;  ///< unique in its dashboard
    Kind kind = Kind::kValue;
    std::string title;  ///< empty: what it is made of
    std::string size;   ///< "small", "wide" or "large"; empty: "small"
    std::string board, service;
    std::string event, key;  ///< what it reads of reports: `key` is "", "0" or "0.pulse" within the event
    std::string unit;
    std::string command;                             ///< what it sends, or reads of what was set
    nlohmann::json args = nlohmann::json::object();  ///< its fixed arguments, by name
    std::string argument;                            ///< the one that varies; empty: the only one
    nlohmann::json on = 1, off = 0;                  ///< of a switch and a lamp
    double min = 0, max = 1, step = 0;               ///< of a slider; step 0: any

    /// It sends commands.
    bool sends() const { return kind == Kind::kSwitch || kind == Kind::kSlider; }
    /// It reads reports; otherwise what was set.
    bool reads_event() const { return !event.empty(); }
    /// Whether it may send `value`; a sentence why not.
    Expected<void> may_send(const nlohmann::json& value) const;
    /// The arguments of its command with this value.
    nlohmann::json arguments(const nlohmann::json& value) const;
    /// What it shows of a report, an object by event; nothing: the report says nothing of it.
    std::optional<nlohmann::json> read_report(const nlohmann::json& value) const;
    /// What it shows of what was set in its service; null: not known.
    nlohmann::json read_set(const nlohmann::json& set) const;
};

/// A link that shows a dashboard to its holder. Of its token only the hash is kept.
struct DashboardLink {
    std::string name;
    std::string hash;
    std::string by;  ///< the user who made it
    bool control = false;
    std::optional<text::WallTime> until;
};

/// A dashboard as it is retained on the bus. A value.
struct Dashboard {
    static constexpr std::size_t kMaxBytes = std::size_t{16} * 1024;  ///< of what a client sends
    static constexpr std::size_t kMaxKept = std::size_t{32} * 1024;   ///< of what is retained
    static constexpr std::size_t kMaxWidgets = 48;
    static constexpr std::size_t kMaxLinks = 16;

    std::string title;
    std::vector<Widget> widgets;
    std::vector<DashboardLink> links;
    std::string by, changed;  ///< the user who changed it last, and when

    const Widget* widget(std::string_view id) const;
    const DashboardLink* link(std::string_view name) const;
    /// In the order of the widgets.
    std::vector<std::string> boards() const;
    /// Whether a client with these rights sees all of it; `name`: its own.
    bool seen_by(const Rights& rights, std::string_view name) const;
};

/// A name that a dashboard may have: that of a board, but none at which a topic of a service would end.
bool valid_dashboard_name(std::string_view name);
inline constexpr const char* kDashboardNameForm =
    "a dashboard's name is 1 to 64 of A-Z a-z 0-9 . _ -, and none of in, out, error and set";

/// What a client sends: `{"title":..,"widgets":[..]}`. Widgets without an id are given one. The error names
/// the place of the fault.
Expected<Dashboard> parse_dashboard(std::string_view text);
/// What is retained.
Expected<Dashboard> parse_kept_dashboard(std::string_view text);
/// What is retained; parse_kept_dashboard() reads it back.
std::string kept_text(const Dashboard& dashboard);
/// What clients are shown: without links.
nlohmann::json to_json(const Dashboard& dashboard);
/// Of title and widgets: another one for whatever an editor changes.
std::string etag_of(const Dashboard& dashboard);
/// What a client with this link may do.
Rights rights_of(const std::string& dashboard, const DashboardLink& link);

}  // namespace asip::gateway
