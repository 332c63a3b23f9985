// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxRawLines = 64;

bool valid_key(std::string_view key) {
    return key.size() <= Commands::kMaxIdBytes && std::all_of(key.begin(), key.end(), [](char c) {
               return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.' ||
                      c == ':';
           });
}

std::string reply_text(const CommandRecord& record) {
    return text_for_clients(*record.reply);
}

}  // namespace

http::Response response_for(const CommandRecord& record, const std::string& base_path) {
    const auto& reply = *record.reply;
    const int status = http_status(reply);
    const std::string location = base_path + "/api/commands/" + record.id;
    if (status == 200) {
        auto response = text_response(reply_text(record));
        response.headers.emplace_back("Location", location);
        return response;
    }
    json members = json::parse(reply_text(record), nullptr, false);
    members["outcome"] = members["status"];
    auto response = problem(status, bus::why_of(reply), std::move(members));
    response.headers.emplace_back("Location", location);
    return response;
}

namespace {

Expected<std::chrono::milliseconds> deadline_of(const Call& call) {
    const auto ms =
        whole_parameter(call, "deadline_ms", 5000, bus::kMinDeadline.count(), bus::kMaxDeadline.count());
    if (!ms) return Unexpected<std::string>(ms.error());
    return std::chrono::milliseconds(*ms);
}

// Nothing: the command can be sent. Else a status and a sentence: what is wrong with it.
std::optional<std::pair<int, std::string>> wrong(const model::ModelPtr& model,
                                                 const bus::ServiceItem& service, const std::string& command,
                                                 const json& payload) {
    if (!model) {
        if (command == "raw") return std::nullopt;
        if (service.id.empty()) return std::nullopt;  // only its name is known: it may have any command
        return std::pair(404, "no model describes service " + service.name + ": only \"raw\" can be sent");
    }
    if (model->command(command) == nullptr) {
        std::vector<std::string> names;
        for (const auto& each : model->commands)
            names.push_back(each.name);
        return std::pair(404, "service " + service.name + " has no command \"" + text::printable(command) +
                                  "\"" + text::did_you_mean(command, names));
    }
    const auto encoded = model::encode_control_json(model.get(), model->id, payload);
    if (!encoded) return std::pair(400, encoded.error());
    return std::nullopt;
}

}  // namespace

Expected<json> body_of(const http::Request& request) {
    if (request.body.empty()) return json(nullptr);
    auto body = model::parse_json(request.body, {.max_bytes = bus::kMaxRequestBytes, .max_depth = 15});
    if (!body) return fail("the body is not JSON: " + body.error());
    return body;
}

std::optional<Commands::Start> start_of(Call& call) {
    const auto refuse = [&](int status, const std::string& sentence) {
        send_problem(call, status, sentence);
        return std::nullopt;
    };
    const auto deadline = deadline_of(call);
    if (!deadline) return refuse(400, deadline.error());
    std::string id(call.request.header("idempotency-key"));
    if (id.size() > 1 && id.front() == '"' && id.back() == '"') id = id.substr(1, id.size() - 2);
    if (!session_is_valid(call)) return std::nullopt;
    if (!valid_key(id)) return refuse(400, "Idempotency-Key: 1 to 64 of A-Z a-z 0-9 . _ - :");
    if (!call.gateway.command_rates().take(call.client(), call.now().time))
        return refuse(429, "too many commands; try again in a moment");
    Commands::Start start;
    start.session = session_of(call);
    start.id = std::move(id);
    start.by = call.principal.rights.name;
    start.client = call.client();
    start.deadline = *deadline;
    return start;
}

void send(Call& call, std::string target, std::string topic, const json& payload) {
    auto start = start_of(call);
    if (!start) return;
    start->target = std::move(target);
    start->topic = std::move(topic);
    start->payload = model::dump_json(payload);
    call.gateway.command(std::move(*start),
                         [reply = call.reply, base = call.gateway.options().base_path](
                             const CommandRecord& record) { reply.send(response_for(record, base)); });
}

void post_command(Call& call) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (!board) return;
    const auto* service = service_of(call, *board);
    if (service == nullptr) return;
    auto arguments = body_of(call.request);
    if (!arguments) return send_problem(call, 400, arguments.error());
    send_command(call, *board, *service, call.path.find("command")->second, std::move(*arguments));
}

void send_command(Call& call, const bus::BoardItem& board, const bus::ServiceItem& service,
                  const std::string& command, json arguments) {
    auto payload = json::object();
    payload[command] = std::move(arguments);
    const auto model = model_of(call.gateway, board, service.name);
    const auto hold = whole_parameter(call, "hold_ms", 0, 50, 60'000);
    if (!hold) return send_problem(call, 400, hold.error());
    if (const auto fault = wrong(model, service, command, payload))
        return send_problem(call, fault->first, fault->second);
    if (model::is_gone(board.state)) return send_not_there(call, board.board, board.state);
    if (*hold > 0) payload["hold_ms"] = *hold;
    send(call, board.board + "/" + service.name,
         call.gateway.mirror().topics().service_in(board.board, service.name), std::move(payload));
}

void post_raw(Call& call) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (!board) return;
    const auto body = body_of(call.request);
    if (!body) return send_problem(call, 400, body.error());
    const auto lines = body->is_object() ? body->find("lines") : body->end();
    if (!body->is_object() || lines == body->end() || !lines->is_array() || lines->empty() ||
        lines->size() > kMaxRawLines || body->size() != 1) {
        return send_problem(call, 400, "the body must be {\"lines\":[\"I,d,13,1\"]} with 1 to 64 lines");
    }
    std::string text;
    for (const auto& line : *lines) {
        if (!line.is_string()) return send_problem(call, 400, "lines: must be strings");
        if (!text.empty()) text += '\n';
        text += line.get_ref<const std::string&>();
    }
    if (model::is_gone(board->state)) return send_not_there(call, board->board, board->state);
    send(call, board->board, call.gateway.mirror().topics().board_in(board->board), {{"raw", text}});
}

bool has_agent(const Call& call, const bus::BoardItem& board) {
    if (board.state != "offline" && board.reason != "agent-gone" && board.reason != "expired") return true;
    call.reply.send(
        problem(503, "the agent of board " + board.board + " is not there", {{"reason", "board-not-there"}}));
    return false;
}

namespace {

/// What the members may hold is the agent's to say: it has the last word in any case. `usual`: members that
/// the request has where the body has none of that name.
void send_to_agent(Call& call, bool (*is_one)(const json&), const char* form, json usual = json::object()) {
    if (!bus_is_there(call)) return;
    const auto board = board_of(call);
    if (!board) return;
    const auto body = body_of(call.request);
    if (!body) return send_problem(call, 400, body.error());
    if (!is_one(*body)) return send_problem(call, 400, form);
    if (!has_agent(call, *board)) return;
    usual.update(*body);
    send(call, board->board, call.gateway.mirror().topics().board_in(board->board), usual);
}

bool is_label_change(const json& body) {
    if (!body.is_object() || body.empty()) return false;
    for (const auto& [name, member] : body.items())
        if ((name != "labels" && name != "names" && name != "meanings") || !member.is_object()) return false;
    return true;
}

bool is_load(const json& body) {
    if (!body.is_object()) return false;
    for (const auto& [name, member] : body.items()) {
        const bool text = name == "firmware" || name == "board";
        if (!(text && member.is_string()) && !((name == "force" || name == "update") && member.is_boolean()))
            return false;
    }
    return true;
}

}  // namespace

void post_labels(Call& call) {
    send_to_agent(call, is_label_change,
                  "the body must be {\"labels\":{\"room\":\"lab\"}}, "
                  "{\"names\":{\"pins\":{\"13\":\"status lamp\"}}}, "
                  "{\"meanings\":{\"io/2\":{\"class\":\"door\"}}} or several of them");
}

void post_load(Call& call) {
    send_to_agent(call, is_load,
                  "the body must be {}, or have \"firmware\":\"AsipServices\", \"board\":\"mega\", "
                  "\"force\":true",
                  {{"port", "load"}, {"firmware", "AsipServices"}});
}

void get_command(Call& call) {
    const auto& id = call.path.find("id")->second;
    if (!session_is_valid(call)) return;
    const auto* record = call.gateway.commands().find(session_of(call), id);
    if (record == nullptr) {
        return send_problem(
            call, 404,
            "no command \"" + text::printable(id) + "\" of yours is known; answers are kept for a minute");
    }
    json body{{"id", record->id},
              {"target", record->target},
              {"by", record->by},
              {"at", text::iso_time(record->sent.wall)},
              {"request", json::parse(record->request, nullptr, false)}};
    if (record->reply) {
        body["answer"] = json::parse(reply_text(*record), nullptr, false);
        body["late"] = record->late;
    }
    send_json(call, body);
}

namespace {

// What is renewed needs no answer: only if it is not held any more there is one.
void renew(Gateway& gateway, Commands::Start start, const json& request,
           const std::function<void(std::string)>& answer) {
    const auto& which = request["renew"];
    const auto named = which.is_string() ? which.get<std::string>() : start.id;
    json payload{{"renew", true}};
    if (!named.empty()) payload["renew"] = Commands::bus_id(start.session, named);
    if (const auto hold = request.find("hold_ms"); hold != request.end()) payload["hold_ms"] = *hold;
    start.id.clear();
    start.payload = model::dump_json(payload);
    start.renewal = true;
    gateway.command(std::move(start), [answer, named](const CommandRecord& record) {
        if (record.reply->succeeded()) return;
        auto reply = *record.reply;
        reply.id = named;
        answer(text_for_clients(std::move(reply)));
    });
}

// As the agent has it: unless the service has a command of that name.
bool is_renewal(Gateway& gateway, const bus::BoardItem& board, const std::string& service,
                const json& request) {
    if (!request.contains("renew")) return false;
    const auto model = model_of(gateway, board, service);
    return model == nullptr || model->command("renew") == nullptr;
}

}  // namespace

void websocket_command(Gateway& gateway, const Principal& principal, const std::string& client,
                       const std::string& session, const json& request,
                       const std::function<void(std::string)>& answer) {
    std::string id;
    if (const auto found = request.find("id"); found != request.end())
        id = found->is_string() ? found->get<std::string>() : model::dump_json(*found);
    const auto refuse = [&](std::string reason, std::string error) {
        auto reply = bus::Reply::refused(std::move(reason), std::move(error));
        reply.id = id;
        reply.by = principal.rights.name;
        answer(bus::to_json_text(reply));
    };
    if (!valid_key(id)) {
        id.clear();
        return refuse("invalid", "id: 1 to 64 of A-Z a-z 0-9 . _ - :");
    }
    if (!principal.rights.may_command()) return refuse("not-allowed", "this token may only read");
    const auto& target = request["command"];
    const auto text = target.is_string() ? target.get<std::string>() : std::string();
    const auto slash = text.find('/');
    if (slash == std::string::npos) return refuse("invalid", "command: must be \"BOARD/SERVICE\"");
    const auto name = text.substr(0, slash);
    const auto service_name = text.substr(slash + 1);
    const auto board = gateway.mirror().known(name, gateway.now());
    if (!board || !principal.rights.sees_service(name, service_name)) {
        auto names = gateway.mirror().board_names();
        std::erase_if(names, [&](const std::string& each) { return !principal.rights.sees_board(each); });
        return refuse("invalid", "no board \"" + text::printable(name) + "\" is known" +
                                     text::did_you_mean(name, names));
    }
    const auto service = std::find_if(board->services.begin(), board->services.end(),
                                      [&](const auto& each) { return each.name == service_name; });
    if (service == board->services.end())
        return refuse("invalid",
                      "board " + name + " has no service \"" + text::printable(service_name) + "\"");
    if (!gateway.mirror().ready()) return refuse("broker-not-there", "the broker is not connected");
    if (model::is_gone(board->state))
        return refuse("board-not-there", "board " + name + " is " + board->state);
    if (!gateway.command_rates().take(client, gateway.now().time))
        return refuse("too-many", "too many commands; try again in a moment");
    Commands::Start start;
    start.session = session_name(gateway, session);
    start.id = id;
    start.by = principal.rights.name;
    start.target = text;
    start.topic = gateway.mirror().topics().service_in(name, service_name);
    start.client = client;
    if (is_renewal(gateway, *board, service_name, request))
        return renew(gateway, std::move(start), request, answer);
    json payload = request;
    // The gateway itself names the sender, and where the answer goes.
    for (const char* member : {"command", "id", "deadline_ms", "by", "reply_to"})
        payload.erase(member);
    start.payload = model::dump_json(payload);
    if (const auto deadline = request.find("deadline_ms"); deadline != request.end()) {
        const auto ms = deadline->is_number_integer() ? deadline->get<std::int64_t>() : 0;
        if (ms < bus::kMinDeadline.count() || ms > bus::kMaxDeadline.count())
            return refuse("invalid", "deadline_ms: must be a whole number from 50 to 60000");
        start.deadline = std::chrono::milliseconds(ms);
    }
    gateway.command(std::move(start), [answer](const CommandRecord& record) { answer(reply_text(record)); });
}

}  // namespace asip::gateway::api
