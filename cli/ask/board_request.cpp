// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/board_request.hpp"

#include <pwd.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "asip/bus/registry/board_match.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"
#include "asip/protocol/request.hpp"
#include "cli/text/state_text.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

Expected<model::EncodedCommand> encode(const model::ServiceModel& model, std::span<const std::string> words) {
    if (words.size() == 1 && words.front().starts_with("{")) {
        const auto document = model::parse_json(words.front());
        if (!document) return fail(document.error());
        return model::encode_json_command(model, *document);
    }
    return model::encode_word_command(model, words);
}

std::string how_to_use(const model::ServiceModel& model, const std::string& word) {
    const auto* command = model.command(word);
    return command != nullptr ? "; usage: " + command->name + " " + model::usage(*command) : "";
}

std::string all_commands(const model::ServiceModel& model) {
    std::vector<std::string> names;
    for (const auto& command : model.commands)
        names.push_back(command.name);
    return names.empty() ? " It takes none" : " There are " + listed(names);
}

std::string hint_for(const bus::Reply& reply) {
    return reply.reason == bus::kTimeoutNoAnswer ? ". Is the board's agent running? Try: asipctl doctor" : "";
}

}  // namespace

Outcome<BoardCommand> make_command(const Environment& environment, const KnownBoard& board,
                                   const model::ServiceInfo& service, std::span<const std::string> words) {
    const auto topic = environment.topics.service_in(board.item.board, service.name);
    const auto target = board.item.board + "/" + service.name;
    const auto where = target + ": ";
    const auto model = bus::model_of(service, environment.models());
    if (words.empty())
        return failure(program::kExitUsage, where + "which command?" + (model ? all_commands(*model) : ""));
    if (!model) {
        const auto text = listed(words, ",");
        if (text.empty() || text.find_first_of("\r\n") != std::string::npos)
            return failure(program::kExitUsage, where + "a tag and its parameters, as in: W 0 90");
        return BoardCommand{topic, text, service.name + "," + text, target, {}, board.item.names_only};
    }
    auto encoded = encode(*model, words);
    if (!encoded)
        return failure(program::kExitUsage, where + encoded.error() + how_to_use(*model, words.front()));
    // Without its service, as the service's own topic wants it.
    return BoardCommand{topic,         encoded->line.substr(std::min<std::size_t>(2, encoded->line.size())),
                        encoded->line, target,
                        encoded->safe, board.item.names_only};
}

Outcome<BoardCommand> make_raw_command(const Environment& environment, const std::string& board,
                                       const std::string& line) {
    const auto request = protocol::parse_request(line);
    if (!request) {
        return failure(program::kExitUsage,
                       "'" + line + "': " + request.error() + "; a request looks like S,W,0,90");
    }
    return BoardCommand{environment.topics.board_in(board), line, line, board, {}};
}

caller::Command BoardCommand::to_send() const {
    return {.topic = topic, .payload = payload, .plain = plain};
}

Outcome<bus::Reply> ask_board(BusSession& session, caller::Command command) {
    std::optional<bus::Reply> reply;
    const auto call =
        session.command(std::move(command), [&reply](const bus::Reply& answer) { reply = answer; });
    session.run_until([&] { return reply.has_value(); }, Time::max());
    if (!reply) return interrupted();
    return std::move(*reply);
}

std::string who_asks(const Environment& environment) {
    if (!environment.mqtt.user.empty()) return environment.mqtt.user;
    const auto* login = ::getpwuid(::getuid());
    return login != nullptr ? login->pw_name : "uid " + std::to_string(::getuid());
}

int exit_status(const bus::Reply& reply) {
    switch (reply.status) {
        case bus::Reply::Status::kOk:
            return program::kExitOk;
        case bus::Reply::Status::kTimeout:
            return reply.reason == bus::kTimeoutConnection ? program::kExitBroker : program::kExitNoAnswer;
        default:
            return program::kExitFailure;
    }
}

std::string answer_text(const bus::Reply& reply) {
    if (reply.answer.empty()) return "ok";
    const auto document = model::parse_json(reply.answer);
    return document && document->is_string() ? document->get<std::string>() : reply.answer;
}

std::string why_not(const bus::Reply& reply) {
    return reply.status == bus::Reply::Status::kError ? bus::sentence_of(reply) : bus::why_of(reply);
}

std::string note_of(const std::string& board, const bus::Reply& reply) {
    return board + ": " + why_not(reply) + hint_for(reply);
}

Failure failure_of(const bus::Reply& reply, const std::string& where) {
    return {exit_status(reply), where + bus::sentence_of(reply) + hint_for(reply), reply.reason, reply.code};
}

bus::Reply not_waited_for() {
    auto reply = bus::Reply::timeout(bus::kTimeoutNoAnswer);
    reply.error = "interrupted before it was answered";
    return reply;
}

bus::Reply refused_as_lost(const bus::BoardItem& board, const std::string& so) {
    return bus::Reply::refused(std::string(bus::kRefusedBoardNotThere),
                               "it is " + state_text(board) + "; " + so);
}

Outcome<KnownBoard> find_living_board(BoardSource& source, const std::string& name) {
    auto board = source.board(name);
    if (!board) return board;
    if (model::is_gone(board->item.state))
        return failure(program::kExitFailure,
                       name + " is " + state_text(board->item) + "; " + what_to_do(board->item));
    return board;
}

}  // namespace asip::cli
