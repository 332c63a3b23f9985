// SPDX-License-Identifier: Apache-2.0
// The Web of Things over HTTP: descriptions, properties, actions, the directory and its events.
#include "gateway/api/things.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/api/streams.hpp"
#include "gateway/api/things_feeds.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway::api {

using exports::ExportedBoard;
using exports::Kind;
using exports::Property;
using exports::WebOfThings;
using nlohmann::json;

namespace {

constexpr double kHz = 5;     // values of a property that is observed
constexpr double kFresh = 1;  // seconds
constexpr Duration kWait = std::chrono::seconds(1);
constexpr std::int64_t kUsualPage = 100;
constexpr std::int64_t kMaxPage = 250;

http::Response typed(const json& body, const char* type) {
    auto response = json_response(body);
    response.content_type = type;
    return response;
}

/// False: things are turned off.
bool enabled(const Call& call) {
    if (call.gateway.things().options().enabled) return true;
    send_problem(call, 404, "things are turned off (no-wot)");
    return false;
}

WebOfThings::Forms forms_of(const Call& call) {
    using Kind = Principal::Kind;
    const auto& principal = call.principal;
    const std::string host(call.request.header("host").empty() ? "localhost" : call.request.header("host"));
    WebOfThings::Forms forms;
    forms.base = (call.peer.secure ? "https://" : "http://") + host + call.gateway.options().base_path + "/";
    forms.token = principal.kind == Kind::kToken || principal.kind == Kind::kSession;
    forms.may_set = principal.rights.may_command();
    return forms;
}

using Thing = Things::Found;

/// The thing that the path names, or a 404 that names the nearest.
std::optional<Thing> thing_of(const Call& call) {
    if (!enabled(call)) return std::nullopt;
    auto& things = call.gateway.things();
    auto& mirror = call.gateway.mirror();
    const auto name = things.descriptions().board_of(call.path.find("id")->second);
    if (call.sees(name) && mirror.knows(name))
        if (auto found = things.find(mirror, name, call.now())) {
            found->board = seen(call.principal.rights, std::move(found->board));
            return found;
        }
    auto names = mirror.board_names();
    std::erase_if(names, [&](const std::string& each) { return !call.sees(each); });
    send_problem(call, 404,
                 "there is no thing \"" + text::printable(name) + "\"" + text::did_you_mean(name, names));
    return std::nullopt;
}

/// The property that the path names, or a 404 that names the nearest. `button`: an action.
const Property* entity_of(const Call& call, const Thing& thing, bool button) {
    const auto& name = call.path.find(button ? "action" : "property")->second;
    std::vector<std::string> names;
    for (const auto& each : thing.board->properties) {
        if ((each.kind == Kind::kButton) != button) continue;
        names.push_back(property::plain_id(each.id));
        if (names.back() == name) return &each;
    }
    send_problem(call, 404,
                 "thing " + thing.board->board + " has no " + (button ? "action" : "property") + " \"" +
                     text::printable(name) + "\"" + text::did_you_mean(name, names));
    return nullptr;
}

property::ShownValue last_value(Gateway& gateway, const std::string& board, const Property& property) {
    return gateway.mirror().shown(board, property, gateway.now()).value_or(property::ShownValue());
}

void send_value(const http::Reply& reply, Gateway& gateway, const std::string& board,
                const Property& property) {
    const auto last = last_value(gateway, board, property);
    if (!last.value.is_null()) return reply.send(json_response(last.value));
    reply.send(problem(404, property.name + " of " + board + " has no value yet" +
                                (property.read ? "" : ": nothing was set since the board started")));
}

std::unique_ptr<ValueFeed> values_of(const Call& call, const std::string& board, const std::string& service,
                                     Place after) {
    ValueFeed::Options options;
    options.board = board;
    options.service = service;
    options.after = std::move(after);
    options.demand = call.gateway.caller().want(board, service, kHz);
    options.part = call.part();
    return std::make_unique<ValueFeed>(call.gateway.mirror().values(), std::move(options));
}

/// A board that reports on demand may have reported long ago: then the next value is waited for.
void read_value(Call& call, const Thing& thing, const Property& property) {
    auto& gateway = call.gateway;
    const auto& board = thing.board->board;
    const auto now = call.now().time;
    if (!property.read || !model::takes_commands(thing.state) || !gateway.mirror().ready())
        return send_value(call.reply, gateway, board, property);
    const bool first = gateway.things().want(gateway.caller(), board, property.service, now);
    const auto last = last_value(gateway, board, property);
    const bool fresh = last.age < kFresh;
    if ((!last.value.is_null() && (fresh || !first)) || !gateway.streams().has_room(call.client()))
        return send_value(call.reply, gateway, board, property);
    const auto& values = gateway.mirror().values();
    const auto* found = values.find(board, property.service);
    auto feed =
        values_of(call, board, property.service, Place{values.epoch(), found == nullptr ? 0 : found->last});
    if (!feed->fault().empty()) return send_value(call.reply, gateway, board, property);
    gateway.wait_for_value(std::move(feed), kWait, call.reply, call.principal, call.client(),
                           [&gateway, reply = call.reply, board, property](bool revoked) {
                               if (revoked)
                                   return reply.send(problem(401, "the right to read this was taken back"));
                               send_value(reply, gateway, board, property);
                           });
}

/// Commands that set one thing, one after the other.
struct Setting : std::enable_shared_from_this<Setting> {
    Setting(Gateway& of, Commands::Start first, std::vector<property::Request> all, http::Reply to)
        : gateway(of), start(std::move(first)), requests(std::move(all)), reply(std::move(to)) {}

    void next() {
        Commands::Start command;
        command.session = start.session;
        command.by = start.by;
        command.client = start.client;
        command.deadline = start.deadline;
        if (at == 0) command.id = start.id;  // what follows belongs to it
        command.payload = requests[at].payload;
        command.topic = gateway.mirror().topics().service_in(start.target, requests[at].service);
        command.target = start.target + "/" + requests[at].service;
        gateway.command(std::move(command),
                        [self = shared_from_this()](const CommandRecord& record) { self->answered(record); });
    }
    void answered(const CommandRecord& record) {
        if (!record.reply->succeeded()) return reply.send(response_for(record, gateway.options().base_path));
        if (++at < requests.size()) return next();
        http::Response done;
        done.status = 204;
        reply.send(std::move(done));
    }

    Gateway& gateway;
    Commands::Start start;  // `target`: the board
    std::vector<property::Request> requests;
    http::Reply reply;
    std::size_t at = 0;
};

}  // namespace

void set_property(Call& call, const Things::Found& thing, const Property& property, const json& value) {
    if (!bus_is_there(call)) return;
    if (!property.refused.empty()) return send_problem(call, 409, property.refused);
    auto requests = requests_for(property, value);
    if (requests.empty())
        return send_problem(call, 400,
                            property.name + " cannot be set to " + text::printable(model::dump_json(value)));
    if (!model::takes_commands(thing.state)) return send_not_there(call, thing.board->board, thing.state);
    auto start = start_of(call);
    if (!start) return;
    start->target = thing.board->board;
    std::make_shared<Setting>(call.gateway, std::move(*start), std::move(requests), call.reply)->next();
}

/// A page of things, one made in each turn.
struct Page {
    Gateway& gateway;
    http::Reply reply;
    Rights rights;
    WebOfThings::Forms forms;
    std::vector<std::string> names;
    std::string next;  ///< header Link; empty: it is the last page
    std::size_t at = 0;
    std::string text = "[";

    bool step() {
        if (at == names.size()) {
            auto response = text_response(text + "]");
            response.content_type = "application/ld+json";
            if (!next.empty()) response.headers.emplace_back("Link", next);
            reply.send(std::move(response));
            return false;
        }
        auto& things = gateway.things();
        if (auto found = things.find(gateway.mirror(), names[at++], gateway.now()))
            text += (text.size() > 1 ? "," : "") + model::dump_json(things.descriptions().thing(
                                                       *seen(rights, std::move(found->board)), forms));
        return true;
    }
};

void get_things(Call& call) {
    if (!enabled(call)) return;
    const auto offset = whole_parameter(call, "offset", 0, 0, 1'000'000'000);
    if (!offset) return send_problem(call, 400, offset.error());
    const auto limit = whole_parameter(call, "limit", kUsualPage, 1, 1'000'000'000);
    if (!limit) return send_problem(call, 400, limit.error());
    const auto page = std::min(*limit, kMaxPage);
    auto names = call.gateway.mirror().board_names();
    std::erase_if(names, [&](const std::string& each) { return !call.sees(each); });
    std::sort(names.begin(), names.end());
    const auto begin = std::min<std::ptrdiff_t>(*offset, std::ssize(names));
    const auto end = std::min<std::ptrdiff_t>(begin + page, std::ssize(names));
    std::string next;
    if (end < std::ssize(names))
        next = "<" + call.gateway.options().base_path + "/things?offset=" + std::to_string(end) +
               "&limit=" + std::to_string(page) + ">; rel=\"next\"";
    const auto made = std::make_shared<Page>(Page{call.gateway,
                                                  call.reply,
                                                  call.principal.rights,
                                                  forms_of(call),
                                                  {names.begin() + begin, names.begin() + end},
                                                  std::move(next)});
    call.reply.in_turns([made] { return made->step(); });
}

void get_thing(Call& call) {
    const auto thing = thing_of(call);
    if (!thing) return;
    call.reply.send(typed(call.gateway.things().descriptions().thing(*thing->board, forms_of(call)),
                          "application/td+json"));
}

void get_directory(Call& call) {
    if (!enabled(call)) return;
    call.reply.send(
        typed(call.gateway.things().descriptions().directory(forms_of(call)), "application/td+json"));
}

void get_properties(Call& call) {
    const auto thing = thing_of(call);
    if (!thing) return;
    json values{{std::string(WebOfThings::kBoardState), thing->state}};
    for (const auto& property : thing->board->properties) {
        if (property.kind == Kind::kButton) continue;
        if (property.read && model::takes_commands(thing->state))
            call.gateway.things().want(call.gateway.caller(), thing->board->board, property.service,
                                       call.now().time);
        if (auto last = last_value(call.gateway, thing->board->board, property); !last.value.is_null())
            values[property::plain_id(property.id)] = std::move(last.value);
    }
    send_json(call, values);
}

void get_property(Call& call) {
    const auto thing = thing_of(call);
    if (!thing) return;
    const auto& name = call.path.find("property")->second;
    if (name == WebOfThings::kBoardState && thing->board->property(name) == nullptr)
        return send_json(call, thing->state);
    if (const auto* property = entity_of(call, *thing, false)) read_value(call, *thing, *property);
}

void put_property(Call& call) {
    const auto thing = thing_of(call);
    const auto* property = thing ? entity_of(call, *thing, false) : nullptr;
    if (property == nullptr) return;
    const auto value = body_of(call.request);
    if (!value) return send_problem(call, 400, value.error());
    set_property(call, *thing, *property, *value);
}

void post_action(Call& call) {
    const auto thing = thing_of(call);
    if (!thing) return;
    if (const auto* property = entity_of(call, *thing, true)) set_property(call, *thing, *property, nullptr);
}

void get_property_stream(Call& call) {
    const auto thing = thing_of(call);
    const auto* property = thing ? entity_of(call, *thing, false) : nullptr;
    if (property == nullptr || !bus_is_there(call) || !has_room(call)) return;
    auto options = feed_options(call, thing->board->board, property->service, kHz);
    options.ids = {property->id};
    auto feed = std::make_unique<PropertyFeed>(call.gateway.mirror(), std::move(options));
    if (!feed->fault().empty()) return send_problem(call, 429, std::string(feed->fault()));
    start_sse(call, property_values(std::move(feed), property->id));
}

void get_thing_events(Call& call) {
    if (!enabled(call) || !bus_is_there(call) || !has_room(call)) return;
    auto after = resume_place(call);
    if (!after) return send_problem(call, 400, after.error());
    std::string only;
    if (const auto type = call.path.find("type"); type != call.path.end()) only = type->second;
    if (!only.empty() && only != "thing_created" && only != "thing_updated" && only != "thing_deleted")
        return send_problem(call, 404, "there are thing_created, thing_updated and thing_deleted");
    const auto& rights = call.principal.rights;
    auto& mirror = call.gateway.mirror();
    ChangeFeed::Options options;
    options.after = std::move(*after);
    options.snapshot = false;
    options.allowed = boards_of(rights);
    options.part = call.part();
    auto feed = std::make_unique<ChangeFeed>(
        mirror.log(),
        mirror.read_page(boards_of(rights), [rights](bus::BoardItem& item) { limit_to(rights, item); }),
        std::move(options));
    start_sse(call, things_feed(std::move(feed), call.gateway.things().descriptions(), std::move(only)));
}

}  // namespace asip::gateway::api
