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

using exports::Entity;
using exports::EntityKind;
using exports::ExportedBoard;
using exports::WebOfThings;
using nlohmann::json;

std::shared_ptr<const ExportedBoard> Things::find(const bus::BoardItem& item) {
    const auto hash = std::hash<std::string>()(item.description);
    if (const auto known = boards_.find(item.board); known != boards_.end() && known->second.hash == hash &&
                                                     known->second.bytes == item.description.size())
        if (auto board = known->second.board.lock()) return board;
    auto made = exports::exported_board(item, models_);
    if (!made) return nullptr;
    auto board = std::make_shared<const ExportedBoard>(std::move(*made));
    if (boards_.size() >= tidy_at_) {
        std::erase_if(boards_, [](const auto& each) { return each.second.board.expired(); });
        tidy_at_ = 2 * std::max(kMaxBoards, boards_.size());
    }
    boards_[item.board] = {hash, item.description.size(), board};
    last_.push_back(board);
    if (last_.size() > kMaxBoards) last_.pop_front();
    return board;
}

bool Things::want(bus::Demander& demander, const std::string& board, const std::string& service, Time now) {
    std::erase_if(wants_, [&](const auto& each) { return each.second.until <= now; });
    const auto found = wants_.find({board, service});
    const bool is_new = found == wants_.end();
    if (is_new && wants_.size() >= kMaxWants) return true;
    auto& wanted = wants_[{board, service}];
    wanted.until = now + kWantFor;
    if (is_new) wanted.want = demander.want(board, service);
    return is_new;
}

namespace {

constexpr double kHz = 5;  // values of a property that is observed
constexpr Duration kFresh = std::chrono::seconds(1);
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
    send_problem(call, 404, "things are turned off (--no-wot)");
    return false;
}

WebOfThings::Forms forms_of(const Call& call) {
    using Kind = Principal::Kind;
    const auto& options = call.gateway.things().options();
    const auto& principal = call.principal;
    const std::string host(call.request.header("host").empty() ? "localhost" : call.request.header("host"));
    WebOfThings::Forms forms;
    forms.base = (call.peer.secure ? "https://" : "http://") + host + call.gateway.options().base_path + "/";
    forms.token = principal.kind == Kind::kToken || principal.kind == Kind::kSession;
    forms.may_set = principal.rights.may_command();
    forms.broker = options.broker;
    if (options.broker.starts_with(":")) {
        const auto name = host_part(host);
        forms.broker =
            "mqtt://" + (name.find(':') == std::string::npos ? name : "[" + name + "]") + options.broker;
    }
    forms.broker_password = options.broker_password;
    return forms;
}

/// As its asker sees it.
std::shared_ptr<const ExportedBoard> seen(const Rights& rights, std::shared_ptr<const ExportedBoard> board) {
    if (rights.services.empty()) return board;
    auto limited = std::make_shared<ExportedBoard>(*board);
    std::erase_if(limited->entities,
                  [&](const Entity& each) { return !rights.sees_service(board->board, each.service()); });
    return limited;
}

struct Thing {
    std::string state;
    std::shared_ptr<const ExportedBoard> board;
};

/// The thing that the path names, or a 404 that names the nearest.
std::optional<Thing> thing_of(const Call& call) {
    if (!enabled(call)) return std::nullopt;
    auto& things = call.gateway.things();
    auto& mirror = call.gateway.mirror();
    const auto name = things.dialect().board_of(call.path.find("id")->second);
    if (call.sees(name) && mirror.knows(name)) {
        bus::Query query;
        query.board = name;
        query.full = true;
        const auto found = mirror.find(query, call.now());
        if (found && !found->boards.empty())
            if (auto board = things.find(found->boards[0]))
                return Thing{found->boards[0].state, seen(call.principal.rights, std::move(board))};
    }
    auto names = mirror.board_names();
    std::erase_if(names, [&](const std::string& each) { return !call.sees(each); });
    send_problem(call, 404,
                 "there is no thing \"" + text::printable(name) + "\"" + text::did_you_mean(name, names));
    return std::nullopt;
}

/// The entity that the path names, or a 404 that names the nearest. `button`: an action.
const Entity* entity_of(const Call& call, const Thing& thing, bool button) {
    const auto& name = call.path.find(button ? "action" : "property")->second;
    std::vector<std::string> names;
    for (const auto& each : thing.board->entities) {
        if ((each.kind == EntityKind::kButton) != button) continue;
        if (each.id == name) return &each;
        names.push_back(each.id);
    }
    send_problem(call, 404,
                 "thing " + thing.board->board + " has no " + (button ? "action" : "property") + " \"" +
                     text::printable(name) + "\"" + text::did_you_mean(name, names));
    return nullptr;
}

struct LastValue {
    std::optional<json> value;
    std::optional<Time> seen;  ///< of the service
};

LastValue last_value(Gateway& gateway, const std::string& board, const Entity& entity) {
    LastValue last;
    const auto* values = gateway.mirror().values().find(board, entity.service());
    if (values == nullptr) return last;
    for (const auto& channel : values->channels) {
        if (channel.error || channel.cut > 0 || entity.read.has_value() == channel.set) continue;
        const auto published = model::parse_json(channel.json());
        if (!published) continue;
        auto value = channel.set ? value_set(entity, *published) : value_in(entity, *published);
        if (!value || value->is_null()) continue;
        last = {std::move(value), channel.seen.time};
    }
    return last;
}

void send_value(const http::Reply& reply, Gateway& gateway, const std::string& board, const Entity& entity) {
    const auto last = last_value(gateway, board, entity);
    if (last.value) return reply.send(json_response(*last.value));
    reply.send(problem(404, entity.name + " of " + board + " has no value yet" +
                                (entity.read ? "" : ": nothing was set since the board started")));
}

std::unique_ptr<ValueFeed> values_of(const Call& call, const std::string& board, const std::string& service,
                                     std::optional<Place> after) {
    ValueFeed::Options options;
    options.board = board;
    options.service = service;
    options.max_hz = kHz;
    options.after = std::move(after);
    options.demand = call.gateway.demander().want(board, service, kHz);
    options.part = call.part();
    return std::make_unique<ValueFeed>(call.gateway.mirror().values(), std::move(options));
}

/// Of a board that reports on demand the value may be old: then the next one is waited for.
void read_value(Call& call, const Thing& thing, const Entity& entity) {
    auto& gateway = call.gateway;
    const auto& board = thing.board->board;
    const auto now = call.now().time;
    if (!entity.read || !exports::is_there(thing.state) || !gateway.mirror().ready())
        return send_value(call.reply, gateway, board, entity);
    const bool first = gateway.things().want(gateway.demander(), board, entity.service(), now);
    const auto last = last_value(gateway, board, entity);
    const bool fresh = last.seen && now - *last.seen < kFresh;
    if ((last.value && (fresh || !first)) || !gateway.streams().has_room(call.client()))
        return send_value(call.reply, gateway, board, entity);
    const auto& values = gateway.mirror().values();
    const auto* found = values.find(board, entity.service());
    auto feed =
        values_of(call, board, entity.service(), Place{values.epoch(), found == nullptr ? 0 : found->last});
    if (!feed->fault().empty()) return send_value(call.reply, gateway, board, entity);
    gateway.wait_for_value(std::move(feed), kWait, call.reply, call.principal, call.client(),
                           [&gateway, reply = call.reply, board, entity](bool revoked) {
                               if (revoked)
                                   return reply.send(problem(401, "the right to read this was taken back"));
                               send_value(reply, gateway, board, entity);
                           });
}

/// Commands that set one thing, one after the other.
struct Setting : std::enable_shared_from_this<Setting> {
    Setting(Gateway& of, Commands::Start first, std::vector<exports::Request> all, http::Reply to)
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
    std::vector<exports::Request> requests;
    http::Reply reply;
    std::size_t at = 0;
};

void set(Call& call, const Thing& thing, const Entity& entity, const json& value) {
    if (!bus_is_there(call)) return;
    auto requests = requests_for(entity, value);
    if (requests.empty())
        return send_problem(call, 400,
                            entity.name + " cannot be set to " + text::printable(model::dump_json(value)));
    if (!exports::is_there(thing.state)) {
        return call.reply.send(problem(503, "board " + thing.board->board + " is " + thing.state,
                                       {{"reason", "board-not-there"}}));
    }
    auto start = start_of(call);
    if (!start) return;
    start->target = thing.board->board;
    std::make_shared<Setting>(call.gateway, std::move(*start), std::move(requests), call.reply)->next();
}

}  // namespace

void get_things(Call& call) {
    if (!enabled(call)) return;
    const auto offset = whole_parameter(call, "offset", 0, 0, 1'000'000'000);
    if (!offset) return send_problem(call, 400, offset.error());
    const auto limit = whole_parameter(call, "limit", kUsualPage, 1, 1'000'000'000);
    if (!limit) return send_problem(call, 400, limit.error());
    const auto page = std::min(*limit, kMaxPage);
    auto& things = call.gateway.things();
    auto& mirror = call.gateway.mirror();
    auto names = mirror.board_names();
    std::erase_if(names, [&](const std::string& each) { return !call.sees(each); });
    std::sort(names.begin(), names.end());
    const auto forms = forms_of(call);
    auto list = json::array();
    bus::Query query;
    query.full = true;
    auto at = static_cast<std::size_t>(std::min<std::int64_t>(*offset, std::ssize(names)));
    const auto end = std::min(names.size(), at + static_cast<std::size_t>(page));
    for (; at < end; ++at) {
        query.board = names[at];
        const auto found = mirror.find(query, call.now());
        if (!found || found->boards.empty()) continue;
        if (auto board = things.find(found->boards[0]))
            list.push_back(things.dialect().thing(*seen(call.principal.rights, std::move(board)), forms));
    }
    auto response = typed(list, "application/ld+json");
    if (end < names.size())
        response.headers.emplace_back("Link", "<" + call.gateway.options().base_path +
                                                  "/things?offset=" + std::to_string(end) +
                                                  "&limit=" + std::to_string(page) + ">; rel=\"next\"");
    call.reply.send(std::move(response));
}

void get_thing(Call& call) {
    const auto thing = thing_of(call);
    if (!thing) return;
    call.reply.send(
        typed(call.gateway.things().dialect().thing(*thing->board, forms_of(call)), "application/td+json"));
}

void get_directory(Call& call) {
    if (!enabled(call)) return;
    call.reply.send(typed(call.gateway.things().dialect().directory(forms_of(call)), "application/td+json"));
}

void get_properties(Call& call) {
    const auto thing = thing_of(call);
    if (!thing) return;
    json values{{std::string(WebOfThings::kBoardState), thing->state}};
    for (const auto& entity : thing->board->entities) {
        if (entity.kind == EntityKind::kButton) continue;
        if (entity.read && exports::is_there(thing->state))
            call.gateway.things().want(call.gateway.demander(), thing->board->board, entity.service(),
                                       call.now().time);
        if (auto last = last_value(call.gateway, thing->board->board, entity); last.value)
            values[entity.id] = std::move(*last.value);
    }
    send_json(call, values);
}

void get_property(Call& call) {
    const auto thing = thing_of(call);
    if (!thing) return;
    const auto& name = call.path.find("property")->second;
    if (name == WebOfThings::kBoardState && thing->board->entity(name) == nullptr)
        return send_json(call, thing->state);
    if (const auto* entity = entity_of(call, *thing, false)) read_value(call, *thing, *entity);
}

void put_property(Call& call) {
    const auto thing = thing_of(call);
    const auto* entity = thing ? entity_of(call, *thing, false) : nullptr;
    if (entity == nullptr) return;
    const auto value = body_of(call.request);
    if (!value) return send_problem(call, 400, value.error());
    set(call, *thing, *entity, *value);
}

void post_action(Call& call) {
    const auto thing = thing_of(call);
    if (!thing) return;
    if (const auto* entity = entity_of(call, *thing, true)) set(call, *thing, *entity, nullptr);
}

void get_property_stream(Call& call) {
    const auto thing = thing_of(call);
    const auto* entity = thing ? entity_of(call, *thing, false) : nullptr;
    if (entity == nullptr || !bus_is_there(call) || !has_room(call)) return;
    auto after = resume_place(call);
    if (!after) return send_problem(call, 400, after.error());
    auto feed = values_of(call, thing->board->board, entity->service(), std::move(*after));
    if (!feed->fault().empty()) return send_problem(call, 429, std::string(feed->fault()));
    start_sse(call, property_feed(std::move(feed), *entity));
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
    start_sse(call, things_feed(std::move(feed), call.gateway.things().dialect(), std::move(only)));
}

}  // namespace asip::gateway::api
