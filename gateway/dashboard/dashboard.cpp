// SPDX-License-Identifier: Apache-2.0
#include "gateway/dashboard/dashboard.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "gateway/auth/secret.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;

const json* at_key(const json& value, const std::string& key) {
    if (value.is_object()) {
        const auto found = value.find(key);
        return found == value.end() ? nullptr : &*found;
    }
    if (!value.is_array() || key.empty() || key.size() > 4 ||
        key.find_first_not_of("0123456789") != std::string::npos)
        return nullptr;
    const auto index = static_cast<std::size_t>(std::stoi(key));
    return index < value.size() ? &value[index] : nullptr;
}

}  // namespace

Expected<void> Widget::may_send(const json& value) const {
    if (kind == Kind::kSwitch) {
        if (value == on || value == off) return {};
        return fail("value: this switch sends " + on.dump() + " and " + off.dump());
    }
    if (value.is_number() && value.get<double>() >= min && value.get<double>() <= max) return {};
    return fail("value: must be a number from " + json(min).dump() + " to " + json(max).dump());
}

json Widget::arguments(const json& value) const {
    auto all = args;
    all[argument] = value;
    return all;
}

std::optional<json> Widget::read_report(const json& value) const {
    const auto* found = value.is_object() ? at_key(value, event) : nullptr;
    for (std::size_t at = 0; found != nullptr && at < key.size();) {
        const auto dot = std::min(key.find('.', at), key.size());
        found = at_key(*found, key.substr(at, dot - at));
        at = dot + 1;
    }
    return found == nullptr ? std::nullopt : std::optional(*found);
}

json Widget::read_set(const json& set) const {
    const auto* found = set.is_object() ? at_key(set, command) : nullptr;
    if (found == nullptr) return nullptr;
    // By element, where the command has one: it is one of the fixed arguments.
    for (const auto& fixed : args) {
        const auto* inner = found->is_object()
                                ? at_key(*found, fixed.is_string() ? fixed.get<std::string>() : fixed.dump())
                                : nullptr;
        if (inner != nullptr) found = inner;
    }
    if (!found->is_object()) return *found;
    const auto* inner = argument.empty() ? nullptr : at_key(*found, argument);
    return inner == nullptr ? json(nullptr) : *inner;
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
        return each.board.empty() || rights.sees_service(each.board, each.service);
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
    rights.dashboard = dashboard;
    rights.control = link.control;
    rights.until = link.until;
    rights.token_hash = link.hash;
    return rights;
}

}  // namespace asip::gateway
