// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

json model_json(const model::ServiceModel& model) {
    return json::parse(model.source, nullptr, false);
}

json value_item(const Values& values, const ServiceValues& service, const Point& point) {
    const auto& channel = service.channels[point.channel];
    json item{{"place", Place{values.epoch(), point.number}.text()},
              {"at", text::iso_time(point.seen.wall)},
              {channel.error ? "error" : "value", json::parse(point.json, nullptr, false)}};
    if (point.cut > 0) item["cut"] = point.cut;
    return item;
}

void send_value(const http::Reply& reply, Gateway& gateway, const std::string& board,
                const std::string& service) {
    const auto now = gateway.now();
    const auto& values = gateway.mirror().values();
    const auto* found = values.find(board, service);
    json events = json::object();
    for (std::size_t i = 0; found != nullptr && i < found->channels.size(); ++i) {
        const auto& channel = found->channels[i];
        const auto key = channel.error ? "error" : channel.event.empty() ? "value" : channel.event;
        json value = json::parse(channel.json(), nullptr, false);
        if (!channel.event.empty() && channel.cut == 0) value = json(value.front());
        const std::chrono::duration<double> age = now.time - channel.seen.time;
        events[key] = {{"value", std::move(value)},
                       {"at", text::iso_time(channel.seen.wall)},
                       {"age", std::round(age.count() * 1000) / 1000}};
        if (channel.cut > 0) events[key]["cut"] = channel.cut;
    }
    const std::uint64_t last = found == nullptr ? 0 : found->last;
    reply.send(json_response({{"board", board},
                              {"service", service},
                              {"place", Place{values.epoch(), last}.text()},
                              {"events", std::move(events)}}));
}

Expected<std::optional<Place>> place_parameter(const Call& call, std::string_view name) {
    const auto* text = call.request.parameter(name);
    if (text == nullptr) return std::optional<Place>();
    auto place = parse_place(*text);
    if (!place) return fail(std::string(name) + ": must be a place such as 1f2e3d4c-17");
    return place;
}

// The first point behind a place or a time; null: none is.
std::size_t first_behind(const ServiceValues& service, const std::string& epoch,
                         const std::optional<Place>& place, const std::optional<text::WallTime>& time) {
    std::size_t at = 0;
    while (at < service.points.size()) {
        const auto& point = service.points[at];
        const bool behind_place = !place || place->epoch != epoch || point.number > place->number;
        if (behind_place && (!time || point.seen.wall > *time)) break;
        ++at;
    }
    return at;
}

}  // namespace

void get_service(Call& call) {
    const auto board = board_of(call);
    if (!board) return;
    const auto* service = service_of(call, *board);
    if (service == nullptr) return;
    json body = bus::to_json(*service);
    if (const auto model = model_of(call.gateway, *board, service->name)) body["model"] = model_json(*model);
    send_json(call, body);
}

void get_value(Call& call) {
    const auto board = board_of(call);
    if (!board || service_of(call, *board) == nullptr) return;
    const auto wait = number_parameter(call, "wait", 0, 0, 60);
    if (!wait) return send_problem(call, 400, wait.error());
    const auto after = place_parameter(call, "after");
    if (!after) return send_problem(call, 400, after.error());
    auto& values = call.gateway.mirror().values();
    const auto* found = values.find(call.board(), call.service());
    const std::uint64_t last = found == nullptr ? 0 : found->last;
    const bool newer = *after && ((*after)->epoch != values.epoch() || (*after)->number != last);
    if (*wait == 0 || newer) return send_value(call.reply, call.gateway, call.board(), call.service());
    if (!bus_is_there(call) || !has_room(call)) return;
    ValueFeed::Options options;
    options.board = call.board();
    options.service = call.service();
    options.after = Place{values.epoch(), last};
    options.demand = demand_within(call.principal.rights, call.gateway.caller(), options.board,
                                   options.service, bus::kUsualHz, options.demands);
    const auto limit = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(*wait));
    options.part = call.part();
    auto feed = std::make_unique<ValueFeed>(values, std::move(options));
    if (!feed->fault().empty()) return send_problem(call, 429, std::string(kTooMuchKept));
    call.gateway.wait_for_value(
        std::move(feed), limit, call.reply, call.principal, call.client(),
        [&gateway = call.gateway, reply = call.reply, name = call.board(),
         service = call.service()](bool revoked) {
            if (revoked) return reply.send(problem(401, "the right to read this was taken back"));
            send_value(reply, gateway, name, service);
        });
}

void get_values(Call& call) {
    const auto board = board_of(call);
    if (!board || service_of(call, *board) == nullptr) return;
    const auto& values = call.gateway.mirror().values();
    const auto* found = values.find(call.board(), call.service());
    std::optional<Place> place;
    std::optional<text::WallTime> time;
    if (const auto* since = call.request.parameter("since")) {
        place = parse_place(*since);
        time = text::parse_iso_time(*since);
        if (time) place.reset();
        if (!place && !time)
            return send_problem(call, 400, "since: must be a place such as 1f2e3d4c-17, or a time");
    }
    json items = json::array();
    bool complete = true;
    std::uint64_t last = 0;
    if (found != nullptr) {
        last = found->last;
        const auto first = first_behind(*found, values.epoch(), place, time);
        for (std::size_t i = first; i < found->points.size(); ++i)
            items.push_back(value_item(values, *found, found->points[i]));
        if (place) {
            const auto oldest = found->points.empty() ? last + 1 : found->points.front().number;
            complete = place->epoch == values.epoch() && place->number + 1 >= oldest;
        }
    }
    send_json(
        call,
        {{"items", std::move(items)}, {"complete", complete}, {"place", Place{values.epoch(), last}.text()}});
}

namespace {

/// The models that a client may read: with limited rights those of the services that are seen.
std::vector<model::ModelPtr> models_for(const Call& call) {
    auto models = call.gateway.models().all();
    const auto& rights = call.principal.rights;
    if (!rights.limited()) return {models.begin(), models.end()};
    const auto kinds = call.gateway.mirror().services_by_kind(view_of(rights));
    std::vector<model::ModelPtr> seen;
    for (auto& model : models)
        if (std::any_of(kinds.begin(), kinds.end(),
                        [&](const auto& kind) { return kind.first == model->name; }))
            seen.push_back(std::move(model));
    return seen;
}

}  // namespace

void get_models(Call& call) {
    json items = json::array();
    for (const auto& model : models_for(call)) {
        items.push_back({{"name", model->name},
                         {"version", model->version},
                         {"id", std::string(1, model->id)},
                         {"title", model->title}});
    }
    send_json(call, {{"items", std::move(items)}});
}

void get_model(Call& call) {
    const auto& name = call.path.find("name")->second;
    const auto known = call.gateway.models().find(name);
    std::vector<std::string> names;
    for (const auto& model : models_for(call)) {
        if (known != nullptr && model->name == known->name) return send_json(call, model_json(*known));
        names.push_back(model->name);
    }
    send_problem(call, 404,
                 "no model \"" + text::printable(name) + "\" is known" + text::did_you_mean(name, names));
}

}  // namespace asip::gateway::api
