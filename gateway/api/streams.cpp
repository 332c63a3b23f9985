// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/bus/request/line_service.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/limits.hpp"
#include "gateway/api/routes.hpp"
#include "gateway/api/streams.hpp"
#include "gateway/auth/secret.hpp"
#include "gateway/dashboard/feed.hpp"
#include "gateway/stream/channel.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway::api {
namespace {

constexpr std::size_t kBytesOfStream = 32 * 1024;  // with what is being sent
constexpr double kMinHz = 0.01;

using nlohmann::json;

ValueFeed::Allowed allowed_services(const Rights& rights) {
    if (!rights.limited()) return {};
    return [rights](std::string_view board, std::string_view service) {
        return rights.sees_service(board, service);
    };
}

/// Whose stream it is.
struct Reader {
    Gateway& gateway;
    Rights rights;
    std::string client;

    Budget::Part part() const { return gateway.budget().part(client); }
};

std::unique_ptr<Feed> catalogue_feed(const Reader& reader, const std::string& board,
                                     std::optional<Place> after) {
    auto& mirror = reader.gateway.mirror();
    const auto& rights = reader.rights;
    auto limit = [rights](bus::BoardItem& item) { limit_to(rights, item); };
    auto feed =
        std::make_unique<ChangeFeed>(mirror.log(), mirror.read_page(boards_of(rights), std::move(limit)),
                                     ChangeFeed::Options{board.empty() ? "*" : board, std::move(after), true,
                                                         boards_of(rights), reader.part()});
    return limited_feed(std::move(feed), rights);
}

/// Behind what a stream goes on.
struct Resume {
    std::optional<Place> place;
    std::optional<Places> places;  ///< of each service
};

Expected<Places> places_of(const json& after) {
    Places places;
    std::set<std::string> epochs;
    for (const auto& [service, text] : after.items()) {
        const auto place = text.is_string() ? parse_place(text.get_ref<const std::string&>()) : std::nullopt;
        if (!place) return fail("after: must be a place such as \"1f2e3d4c-17\", or one for each service");
        epochs.insert(place->epoch);
        if (service == "*")
            places.others = place->number;
        else
            places.services[service] = place->number;
    }
    if (epochs.size() == 1) places.epoch = *epochs.begin();  // of several runs: of none that goes on
    return places;
}

Expected<Resume> resume_of(const json& request) {
    const auto found = request.find("after");
    if (found == request.end() || *found == json::object()) return Resume{};
    if (found->is_object()) {
        auto places = places_of(*found);
        if (!places) return Unexpected<std::string>(places.error());
        return Resume{{}, std::move(*places)};
    }
    auto place = found->is_string() ? parse_place(found->get_ref<const std::string&>()) : std::nullopt;
    if (!place) return fail("after: must be a place such as \"1f2e3d4c-17\", or one for each service");
    return Resume{std::move(place), {}};
}

Expected<std::unique_ptr<Feed>> value_feed(const Reader& reader, const std::string& target, double max_hz,
                                           Resume after) {
    const auto slash = target.find('/');
    if (slash == std::string::npos || target.find('/', slash + 1) != std::string::npos)
        return fail(
            "subscribe: must be \"BOARD/SERVICE\", patterns allowed, \"BOARD/$values\", \"$catalogue\" or "
            "\"$dashboard\"");
    ValueFeed::Options options;
    options.board = target.substr(0, slash);
    options.service = target.substr(slash + 1);
    if (options.board.empty() || options.service.empty())
        return fail("subscribe: board and service must not be empty; * is any");
    const bool pattern = target.find_first_of("*?") != std::string::npos;
    if (options.service == bus::kLineService && (pattern || !reader.rights.may_command()))
        return fail("$line: of one board that you may command");
    if (after.place && pattern)
        return fail(
            "after: of a pattern, an object: the place of snapshot-end as \"*\", and the last one of each "
            "BOARD/SERVICE");
    options.max_hz = max_hz;
    options.after = std::move(after.place);
    options.after_each = std::move(after.places);
    options.allowed = allowed_services(reader.rights);
    options.demand = demand_within(reader.rights, reader.gateway.caller(), options.board, options.service,
                                   max_hz > 0 ? max_hz : bus::kUsualHz, options.demands);
    options.part = reader.part();
    return std::make_unique<ValueFeed>(reader.gateway.mirror().values(), std::move(options));
}

PropertyFeed::Options feed_options(const Reader& reader, const std::string& board, const std::string& service,
                                   double max_hz) {
    auto& gateway = reader.gateway;
    PropertyFeed::Options options;
    options.board = board;
    options.find = [&gateway, rights = reader.rights, board](const Instant& now) -> PropertyFeed::Seen {
        auto found = gateway.things().find(gateway.mirror(), board, now);
        if (!found) return {};
        return {std::move(found->session), seen(rights, std::move(found->board))};
    };
    options.values.board = board;
    options.values.service = service;
    options.values.max_hz = max_hz;
    options.values.allowed = allowed_services(reader.rights);
    options.values.demand = demand_within(reader.rights, gateway.caller(), board, service,
                                          max_hz > 0 ? max_hz : bus::kUsualHz, options.values.demands);
    options.values.part = reader.part();
    options.part = reader.part();
    return options;
}

/// A feed of these properties alone; it demands the reports of their services and of no other.
PropertyFeed::Options only(const Reader& reader, const std::string& board, std::set<std::string> ids,
                           double hz, const std::function<bool(const std::string& service)>& allowed) {
    auto feed = feed_options(reader, board, "*", hz);
    std::set<std::string, std::less<>> services;
    for (const auto& id : ids)
        if (std::string service(property::service_of(id)); allowed(service))
            services.insert(std::move(service));
    auto wants = std::make_shared<std::vector<bus::Demander::Want>>();
    for (const auto& service : services)
        wants->push_back(reader.gateway.caller().want(board, service, hz));
    feed.ids = std::move(ids);
    feed.values.demands = wants->size();
    feed.values.demand = std::move(wants);
    feed.values.allowed = [services = std::move(services)](std::string_view, std::string_view service) {
        return services.contains(service);
    };
    return feed;
}

Expected<PropertyFeed::Options> values_feed(const Reader& reader, const std::string& board,
                                            const json& request, double max_hz) {
    const auto listed = request.find("ids");
    if (listed == request.end()) return feed_options(reader, board, "*", max_hz);
    std::set<std::string> ids;
    for (const auto& id : *listed)
        if (id.is_string()) ids.insert(id.get<std::string>());
    if (!listed->is_array() || ids.size() != listed->size() || ids.empty() ||
        ids.size() > property::kMaxProperties)
        return fail("ids: must be a list of ids of properties, such as [\"distance/0\"]");
    return only(reader, board, std::move(ids), max_hz > 0 ? max_hz : bus::kUsualHz,
                [&](const std::string& service) { return reader.rights.sees_service(board, service); });
}

Expected<std::unique_ptr<Feed>> dashboard_feed(const Reader& reader, const json& request, double max_hz) {
    const auto name = request.find("name");
    if (name == request.end() || !name->is_string()) return fail("name: which dashboard");
    if (request.contains("after")) return fail("after: a dashboard begins with its present state");
    DashboardFeed::Options options;
    options.name = name->get<std::string>();
    options.rights = reader.rights;
    const auto& own = reader.rights.dashboard;
    if (!own.empty() && own != options.name)
        return fail("this link shows the dashboard " + own + " and nothing else");
    // How often boards report is not for a link to say, beyond what a dashboard needs.
    if (max_hz > 0) options.max_hz = own.empty() ? max_hz : std::min(max_hz, options.max_hz);
    options.properties = [reader, hz = options.max_hz](const std::string& board,
                                                       const std::set<std::string>& ids) {
        return only(reader, board, ids, hz, [](const std::string&) { return true; });
    };
    options.part = [reader] { return reader.part(); };
    return std::make_unique<DashboardFeed>(reader.gateway.dashboards(), reader.gateway.mirror(),
                                           std::move(options), reader.gateway.now());
}

Expected<double> max_hz_of(const json& request) {
    const auto found = request.find("max_hz");
    if (found == request.end()) return 0;
    const double max_hz = found->is_number() ? found->get<double>() : 0;
    if (!(max_hz >= kMinHz && max_hz <= kMaxHz)) return fail("max_hz: must be a number from 0.01 to 1000");
    return max_hz;
}

Expected<std::unique_ptr<Feed>> feed_for(const Reader& reader, const json& request) {
    if (!reader.gateway.mirror().ready()) return fail("the broker is not connected; try again in a moment");
    const auto& target = request["subscribe"];
    if (!target.is_string()) return fail("subscribe: must be a string");
    const auto max_hz = max_hz_of(request);
    if (!max_hz) return Unexpected<std::string>(max_hz.error());
    if (target == "$dashboard") return dashboard_feed(reader, request, *max_hz);
    if (const auto& own = reader.rights.dashboard; !own.empty())
        return fail("this link shows the dashboard " + own + " and nothing else");
    auto after = resume_of(request);
    if (!after) return Unexpected<std::string>(after.error());
    if (const auto& text = target.get_ref<const std::string&>(); text.ends_with("/$values")) {
        const auto board = text.substr(0, text.find('/'));
        if (!reader.rights.sees_board(board))
            return fail("there is no board \"" + text::printable(board) + "\"");
        auto options = values_feed(reader, board, request, *max_hz);
        if (!options) return Unexpected<std::string>(options.error());
        return std::make_unique<PropertyFeed>(reader.gateway.mirror(), std::move(*options));
    }
    if (target == "$catalogue") {
        const auto board = request.find("board");
        const bool named = board != request.end() && board->is_string();
        if (after->places) return fail("after: of $catalogue, the last place, as a string");
        return catalogue_feed(reader, named ? board->get<std::string>() : std::string(),
                              std::move(after->place));
    }
    return value_feed(reader, target.get<std::string>(), *max_hz, std::move(*after));
}

Reader reader_of(const Call& call) {
    return {call.gateway, call.principal.rights, call.client()};
}

}  // namespace

PropertyFeed::Options feed_options(const Call& call, const std::string& board, const std::string& service,
                                   double max_hz) {
    return feed_options(reader_of(call), board, service, max_hz);
}

// A new EventSource forgets its own last id: then the parameter has it.
Expected<std::optional<Place>> resume_place(const Call& call) {
    std::string text(call.request.header("last-event-id"));
    if (const auto* parameter = call.request.parameter("last_event_id"); parameter != nullptr && text.empty())
        text = *parameter;
    if (text.empty()) return std::optional<Place>();
    auto place = parse_place(text);
    if (!place) return fail("Last-Event-ID: must be a place such as 1f2e3d4c-17");
    return place;
}

void start_sse(const Call& call, std::unique_ptr<Feed> feed) {
    auto part = call.part();
    if (!feed->fault().empty() || !part.set(kBytesOfStream))
        return send_problem(call, 429, std::string(kTooMuchKept));
    http::Response head;
    head.content_type = "text/event-stream";
    head.headers = {{"Cache-Control", "no-store"}, {"X-Accel-Buffering", "no"}};
    auto& gateway = call.gateway;
    call.reply.stream(std::move(head),
                      std::make_unique<SseSource>(
                          gateway.streams(), std::move(feed), [&gateway] { return gateway.now(); },
                          call.principal, call.client(), std::move(part)));
}

void get_events(Call& call) {
    if (!bus_is_there(call) || !has_room(call)) return;
    auto after = resume_place(call);
    if (!after) return send_problem(call, 400, after.error());
    const auto* board = call.request.parameter("board");
    start_sse(call, catalogue_feed(reader_of(call), board == nullptr ? "" : *board, std::move(*after)));
}

void get_service_stream(Call& call) {
    const auto board = board_of(call);
    if (!board || service_of(call, *board) == nullptr || !bus_is_there(call) || !has_room(call)) return;
    auto after = resume_place(call);
    if (!after) return send_problem(call, 400, after.error());
    const auto max_hz = number_parameter(call, "max_hz", 0, 0, kMaxHz);
    if (!max_hz) return send_problem(call, 400, max_hz.error());
    if (*max_hz > 0 && *max_hz < kMinHz)
        return send_problem(call, 400, "max_hz: 0 for each value, or from 0.01 to 1000");
    auto feed =
        value_feed(reader_of(call), call.board() + "/" + call.service(), *max_hz, {std::move(*after), {}});
    if (!feed) return send_problem(call, 400, feed.error());
    start_sse(call, std::move(*feed));
}

void get_stream(Call& call) {
    if (!http::is_upgrade(call.request)) {
        auto response = problem(426, "this is a WebSocket; see also /api/events");
        response.headers.emplace_back("Upgrade", "websocket");
        return call.reply.send(std::move(response));
    }
    if (!has_room(call)) return;
    auto& gateway = call.gateway;
    const auto principal = call.principal;
    auto part = call.part();
    if (!part.set(gateway.options().socket_bytes)) return send_problem(call, 429, std::string(kTooMuchKept));
    // A client may name its session, so that a command can be repeated over its next connection.
    const auto* named = call.request.parameter("session");
    if (named != nullptr && !valid_session(*named))
        return send_problem(call, 400, "session: " + kSessionForm);
    const auto session =
        call.client() + "\n" + (named != nullptr && !named->empty() ? *named : "socket " + random_secret(12));
    StreamChannel::Dependencies dependencies;
    dependencies.now = [&gateway] { return gateway.now(); };
    dependencies.subscribe = [reader = reader_of(call)](const json& request) {
        return feed_for(reader, request);
    };
    dependencies.part = std::move(part);
    dependencies.command = [&gateway, principal, client = call.client(), session](
                               const json& request, std::function<void(std::string)> answer) {
        websocket_command(gateway, principal, client, session, request, answer);
    };
    dependencies.max_subscriptions = gateway.options().subscriptions;
    call.reply.websocket(std::make_unique<StreamChannel>(gateway.streams(), std::move(dependencies),
                                                         principal, call.client()));
}

}  // namespace asip::gateway::api
