// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/auth/secret.hpp"
#include "gateway/dashboard/feed.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

constexpr std::size_t kTokenBytes = 32;
constexpr std::size_t kNameBytes = 6;
constexpr auto kUsualTime = std::chrono::hours(30 * 24);  // of a link

const std::string& name_of(const Call& call) {
    return call.path.find("dashboard")->second;
}

/// The dashboard, or an answer that says why not.
const Dashboard* dashboard_of(const Call& call) {
    const auto& dashboards = call.gateway.dashboards();
    const auto& rights = call.principal.rights;
    const auto& name = name_of(call);
    if (!rights.dashboard.empty() && rights.dashboard != name) {
        send_problem(call, 403, "this link shows the dashboard " + rights.dashboard + " and nothing else");
        return nullptr;
    }
    const auto* found = dashboards.find(name);
    if (found != nullptr && found->seen_by(rights, name)) return found;
    if (!dashboards.known()) {
        send_problem(call, 503, "what the broker retains is still being read; try again in a moment");
        return nullptr;
    }
    std::vector<std::string> names;
    for (const auto& [each, dashboard] : dashboards.all())
        if (dashboard.seen_by(rights, each)) names.push_back(each);
    send_problem(call, 404,
                 "there is no dashboard \"" + text::printable(name) + "\"" + text::did_you_mean(name, names));
    return nullptr;
}

json links_of(const Dashboard& dashboard) {
    json links = json::array();
    for (const auto& link : dashboard.links) {
        json item{{"name", link.name}, {"by", link.by}, {"control", link.control}};
        if (link.until) item["until"] = text::iso_time(*link.until);
        links.push_back(std::move(item));
    }
    return links;
}

json shown(const Call& call, const std::string& name, const Dashboard& dashboard) {
    auto object = to_json(dashboard);
    object["name"] = name;
    if (!call.principal.rights.dashboard.empty()) object.erase("by");  // a link names no people
    if (call.principal.rights.may_arrange()) object["links"] = links_of(dashboard);
    return object;
}

http::Response response_of(const json& body, const Dashboard& dashboard, int status) {
    auto response = json_response(body, status);
    response.headers.emplace_back("ETag", etag_of(dashboard));
    return response;
}

/// Writes it, and answers once the broker has it.
void write(const Call& call, const std::optional<Dashboard>& dashboard, http::Response answer) {
    call.gateway.dashboards().write(
        name_of(call), dashboard, call.now().time,
        [reply = call.reply, answer = std::move(answer)](const std::string& error) mutable {
            reply.send(error.empty() ? std::move(answer) : problem(503, "not kept: " + error));
        });
}

bool may_write(const Call& call) {
    if (!bus_is_there(call)) return false;
    if (!call.gateway.dashboards().busy(name_of(call))) return true;
    send_problem(call, 409, "this dashboard is being changed at this moment; try again");
    return false;
}

/// Whether the asker knows what it is about to change. Otherwise the answer says so.
bool knows_version(const Call& call, const Dashboard* present) {
    const auto match = call.request.header("if-match");
    const auto none = call.request.header("if-none-match");
    const auto named = "dashboard " + name_of(call);
    if (present == nullptr) {
        if (match.empty() || match == "*") return true;
        send_problem(call, 412, named + " was removed meanwhile; without If-Match it is made anew");
        return false;
    }
    const auto by = present->by.empty() ? std::string() : " by " + text::printable(present->by);
    if (none == "*") {
        send_problem(call, 412, "there is a " + named + " already; choose another name");
        return false;
    }
    if (match.empty()) {
        send_problem(call, 428,
                     "there is a " + named + " already: send its ETag as If-Match, or If-Match: *");
        return false;
    }
    if (match == "*" || match.find(etag_of(*present)) != std::string_view::npos) return true;
    send_problem(call, 412, named + " was changed meanwhile" + by + "; read it again");
    return false;
}

Expected<DashboardLink> read_link(const Call& call, const Dashboard& dashboard) {
    const auto body = model::parse_json(call.request.body.empty() ? "{}" : call.request.body,
                                        {.max_bytes = 1024, .max_depth = 2});
    if (!body) return fail("the body is not JSON: " + body.error());
    if (!body->is_object()) return fail("the body must be {\"until\":\"30d\",\"control\":false}");
    DashboardLink link;
    link.by = call.principal.rights.name;
    link.maker = call.principal.rights.mark();
    link.until = call.now().wall + kUsualTime;
    for (const auto& [name, value] : body->items()) {
        if (name == "control" && value.is_boolean()) {
            link.control = value.get<bool>();
        } else if (name == "name" && value.is_string() && model::valid_name(value.get<std::string>())) {
            link.name = value.get<std::string>();
        } else if (name == "until" && value.is_string()) {
            const auto period = text::parse_duration(value.get<std::string>());
            if (!period) return fail("until: " + period.error());
            link.until = call.now().wall + *period;
        } else if (name == "until" && value.is_null()) {
            link.until.reset();
        } else {
            return fail("\"" + text::printable(name) +
                        "\": the body has until (a time such as 12h or 30d, or null), control (true or "
                        "false) and name");
        }
    }
    if (link.name.empty()) {
        link.name = "link-";
        for (const char c : random_secret(kNameBytes))
            link.name += std::isalnum(static_cast<unsigned char>(c)) ? c : 'x';
    }
    if (dashboard.link(link.name) != nullptr) return fail("name: a link is called " + link.name + " already");
    return link;
}

/// A tile, and the boards of its dashboard.
struct Tile {
    Widget widget;
    std::vector<std::string> boards;
};
/// Or an answer that says why not.
std::optional<Tile> tile_of(const Call& call) {
    if (!bus_is_there(call)) return std::nullopt;
    const auto* kept = dashboard_of(call);
    if (kept == nullptr) return std::nullopt;
    const auto dashboard = with_boards(*kept, call.gateway.mirror(), call.now());
    const auto& id = call.path.find("widget")->second;
    if (const auto* widget = dashboard.widget(id)) return Tile{*widget, dashboard.boards()};
    send_problem(call, 404, "this dashboard has no widget \"" + text::printable(id) + "\"");
    return std::nullopt;
}

/// A switch or a slider: its command goes to its board.
void use(Call& call, const Widget& widget) {
    const auto body = model::parse_json(call.request.body, {.max_bytes = 1024, .max_depth = 2});
    const auto value =
        body && body->is_object() && body->size() == 1 ? body->find("value") : json::const_iterator();
    if (!body || !body->is_object() || body->size() != 1 || value == body->end())
        return send_problem(call, 400, "the body must be {\"value\":1}");
    const auto found = call.gateway.things().find(call.gateway.mirror(), widget.board, call.now());
    if (!found)
        return call.reply.send(problem(503,
                                       "board " + widget.board + " is not known; it may have been forgotten",
                                       {{"reason", "board-not-there"}}));
    for (const auto& each : found->board->properties)
        if (each.id == widget.property)
            return set_property(call, *found, each, property::value_of_control(each, *value));
    send_problem(call, 404, "board " + widget.board + " has no property " + widget.property + " now");
}

}  // namespace

void get_dashboards(Call& call) {
    json items = json::array();
    for (const auto& [name, dashboard] : call.gateway.dashboards().all()) {
        if (!dashboard.seen_by(call.principal.rights, name)) continue;
        items.push_back({{"name", name},
                         {"title", dashboard.title},
                         {"widgets", dashboard.widgets.size()},
                         {"by", dashboard.by},
                         {"changed", dashboard.changed}});
        if (call.principal.rights.may_arrange()) items.back()["links"] = links_of(dashboard);
    }
    send_json(call, {{"items", std::move(items)}});
}

void get_dashboard(Call& call) {
    const auto* dashboard = dashboard_of(call);
    if (dashboard != nullptr)
        call.reply.send(response_of(shown(call, name_of(call), *dashboard), *dashboard, 200));
}

void put_dashboard(Call& call) {
    const auto& name = name_of(call);
    if (!valid_dashboard_name(name)) return send_problem(call, 400, kDashboardNameForm);
    auto dashboard = parse_dashboard(call.request.body);
    if (!dashboard) return send_problem(call, 400, dashboard.error());
    if (!may_write(call)) return;
    auto& dashboards = call.gateway.dashboards();
    const auto* present = dashboards.find(name);
    if (!knows_version(call, present)) return;
    if (present == nullptr && !dashboards.has_room())
        return send_problem(
            call, 409, "there are " + std::to_string(Dashboards::kMax) + " dashboards; remove one first");
    if (present != nullptr) dashboard->links = present->links;
    dashboard->by = call.principal.rights.name;
    dashboard->changed = text::iso_time(call.now().wall);
    auto answer = response_of(shown(call, name, *dashboard), *dashboard, present == nullptr ? 201 : 200);
    write(call, *dashboard, std::move(answer));
}

void delete_dashboard(Call& call) {
    const auto* dashboard = dashboard_of(call);
    if (dashboard == nullptr || !may_write(call)) return;
    if (const auto match = call.request.header("if-match"); !match.empty() && !knows_version(call, dashboard))
        return;
    http::Response answer;
    answer.status = 204;
    write(call, std::nullopt, std::move(answer));
}

void post_widget(Call& call) {
    const auto tile = tile_of(call);
    if (!tile) return;
    if (tile->widget.kind == Widget::Kind::kStop) {
        const auto& rights = call.principal.rights;
        if (rights.may_stop() || rights.control) return stop_boards(call, tile->boards);
        return send_problem(call, 403, "a token that is limited to some services may not stop boards");
    }
    if (!tile->widget.sends())
        return send_problem(call, 400, "this widget only shows something; it takes no value");
    use(call, tile->widget);
}

/// A link shows as much of the past as the plot does, and as much before it, by which it can be moved.
void get_widget_kept(Call& call) {
    const auto tile = tile_of(call);
    if (!tile) return;
    if (tile->widget.kind != Widget::Kind::kPlot) return send_problem(call, 400, "this widget is no plot");
    const bool all = call.principal.rights.dashboard.empty();
    if (!all && tile->widget.span.empty())
        return send_problem(call, 403, "this link shows what is there now; the plot has no span");
    ask_kept(call, tile->widget.board, tile->widget.property,
             all ? text::WallTime{} : call.now().wall - 2 * tile->widget.span_time());
}

void post_link(Call& call) {
    const auto* present = dashboard_of(call);
    if (present == nullptr || !may_write(call)) return;
    auto dashboard = *present;
    std::erase_if(dashboard.links, [now = call.now().wall](const auto& each) {
        return each.until && *each.until <= now;  // it shows nothing any more
    });
    auto link = read_link(call, dashboard);
    if (!link) return send_problem(call, 400, link.error());
    if (dashboard.links.size() >= Dashboard::kMaxLinks)
        return send_problem(call, 409, "this dashboard has as many links as it may have; remove one first");
    const auto token = random_secret(kTokenBytes);
    link->hash = hash_of(token);
    json body{{"name", link->name},
              {"control", link->control},
              {"token", token},
              {"path", call.gateway.options().base_path + "/kiosk/" + token + "/"}};
    if (link->until) body["until"] = text::iso_time(*link->until);
    dashboard.links.push_back(std::move(*link));
    auto answer = json_response(body, 201);
    answer.headers = {{"Cache-Control", "no-store"}};
    write(call, dashboard, std::move(answer));
}

void delete_link(Call& call) {
    const auto* present = dashboard_of(call);
    if (present == nullptr || !may_write(call)) return;
    const auto& name = call.path.find("link")->second;
    if (present->link(name) == nullptr)
        return send_problem(call, 404, "this dashboard has no link \"" + text::printable(name) + "\"");
    auto dashboard = *present;
    std::erase_if(dashboard.links, [&](const auto& each) { return each.name == name; });
    http::Response answer;
    answer.status = 204;
    write(call, dashboard, std::move(answer));
}

}  // namespace asip::gateway::api
