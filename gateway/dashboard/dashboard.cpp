// SPDX-License-Identifier: Apache-2.0
#include "gateway/dashboard/dashboard.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "gateway/auth/secret.hpp"

namespace asip::gateway {
using nlohmann::json;

std::chrono::hours Widget::span_time() const {
    using std::chrono::hours;
    constexpr std::array<hours, kSpans.size()> kTimes{hours(1), hours(24), hours(7 * 24), hours(31 * 24)};
    const auto at = std::find(kSpans.begin(), kSpans.end(), span);
    return at == kSpans.end() ? hours(0) : kTimes.at(static_cast<std::size_t>(at - kSpans.begin()));
}

const Widget* Dashboard::widget(std::string_view id) const {
    const auto found =
        std::find_if(widgets.begin(), widgets.end(), [&](const auto& each) { return each.id == id; });
    return found == widgets.end() ? nullptr : &*found;
}

const DashboardLink* Dashboard::link(std::string_view name) const {
    const auto found =
        std::find_if(links.begin(), links.end(), [&](const auto& each) { return each.name == name; });
    return found == links.end() ? nullptr : &*found;
}

std::vector<std::string> Dashboard::boards() const {
    std::vector<std::string> names;
    for (const auto& widget : widgets)
        if (!widget.board.empty() && std::find(names.begin(), names.end(), widget.board) == names.end())
            names.push_back(widget.board);
    return names;
}

bool Dashboard::seen_by(const Rights& rights, std::string_view name) const {
    if (!rights.dashboard.empty()) return rights.dashboard == name;
    return std::all_of(widgets.begin(), widgets.end(), [&](const Widget& each) {
        if (!each.labels.empty()) return !rights.limited();
        return each.board.empty() || rights.sees_service(each.board, each.service());
    });
}

bool valid_dashboard_name(std::string_view name) {
    return model::valid_name(name) && name != "in" && name != "out" && name != "error" && name != "set";
}

std::string etag_of(const Dashboard& dashboard) {
    constexpr std::size_t kDigits = 16;
    auto object = to_json(dashboard);
    object.erase("by");
    object.erase("changed");
    return "\"" + hash_of(model::dump_json(object)).substr(0, kDigits) + "\"";
}

// No token of the file has such a name.
Rights rights_of(const std::string& dashboard, const DashboardLink& link) {
    Rights rights;
    rights.role = Role::kKiosk;
    rights.name = link.name + "@" + dashboard;
    rights.maker = link.by;
    rights.maker_mark = link.maker;
    rights.dashboard = dashboard;
    rights.control = link.control;
    rights.until = link.until;
    rights.token_hash = link.hash;
    return rights;
}

}  // namespace asip::gateway
