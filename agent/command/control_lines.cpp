// SPDX-License-Identifier: Apache-2.0
// What a command is on the wire, and whether the board can be given it.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "agent/command/control.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/name_budget.hpp"
#include "asip/session/request.hpp"

namespace asip::agent {

namespace {

// Questions whose answer has their own tag; what a raw request is answered with.
char answer_of_question(const protocol::Request& request) {
    return session::is_question(request.service, request.tag) ? request.tag : '\0';
}

}  // namespace

std::string_view Control::first_of_too_many(const Command& command, const Execution& execution) const {
    const auto room = board_.session.room(execution.client);
    if (!command.service.empty() || command.envelope.form != bus::RequestEnvelope::Form::kRaw ||
        room >= protocol::kMaxRequestsPerPayload || !board_.session.accepts_requests())
        return {};
    const auto lines = protocol::lines_of(command.envelope.text);
    const bool told_otherwise = lines.count > protocol::kMaxRequestsPerPayload;  // by read()
    return lines.count > room && !told_otherwise ? lines.first : std::string_view();
}

std::string Control::hold_fault(const Execution& execution, const std::vector<Line>& lines) const {
    if (!execution.hold) return {};
    if (execution.service.empty()) return "only a command on BOARD/SERVICE/in can have a hold";
    if (execution.is_list) return "a list of commands can have no hold";
    if (lines.front().safe.empty()) return "nothing undoes this command, so it cannot have a hold";
    if (!safety_.holds().room_for(lines.front().safe))
        return "this board has " + std::to_string(Holds::kMax) + " holds already";
    return {};
}

Expected<std::vector<Control::Line>> Control::read(const Command& command, Execution& execution,
                                                   const session::ServiceTable::Entry* service) const {
    const auto& envelope = command.envelope;
    const bool raw = envelope.form == bus::RequestEnvelope::Form::kRaw;
    std::vector<Line> result;
    if (service == nullptr) {
        if (!raw)
            return fail(
                "ASIP request lines are expected here, or {\"raw\":\"...\"}; JSON commands go to "
                "BOARD/SERVICE/in");
        const auto requests = protocol::split_requests(envelope.text);
        if (!requests) return fail(requests.error());
        for (const auto& request : *requests)
            result.push_back({request, answer_of_question(request), session::kDefaultAnswerTime,
                              safe_form_of(board_.services, request)});
        return result;
    }
    if (!raw) {
        const auto list = envelope.object.find("commands");
        const auto is_own = [&] { return service->model && service->model->command("commands") != nullptr; };
        if (list != envelope.object.end() && !is_own()) {
            if (envelope.object.size() > 1) return fail("commands: stands beside another command");
            return read_list(*list, execution, *service);
        }
    }
    const auto* model = service->model.get();
    auto line = line_of(raw ? model::encode_control_text(model, service->letter, envelope.text)
                            : model::encode_control_json(model, service->letter, envelope.object),
                        execution.encoded);
    if (!line) return fail(line.error());
    result.push_back(std::move(*line));
    return result;
}

Expected<Control::Line> Control::line_of(Expected<model::EncodedCommand> encoded, std::string& kept) {
    if (!encoded) return fail(encoded.error());
    kept = std::move(encoded->line);
    const auto request = protocol::parse_request(kept);
    if (!request) return fail(request.error());
    Line line{*request, encoded->answer};
    line.safe = std::move(encoded->safe);
    if (encoded->answer_time) line.answer_time = *encoded->answer_time;
    return line;
}

Expected<std::vector<Control::Line>> Control::read_list(const nlohmann::json& list, Execution& execution,
                                                        const session::ServiceTable::Entry& service) const {
    if (!list.is_array() || list.empty() || list.size() > protocol::kMaxRequestsPerPayload)
        return fail("commands: is not a list of 1 to " + std::to_string(protocol::kMaxRequestsPerPayload) +
                    " commands");
    const auto* model = service.model.get();
    std::vector<Line> result;
    execution.is_list = true;
    execution.answers.resize(list.size());
    execution.listed.resize(list.size());
    for (const auto& command : list) {
        auto line = line_of(
            command.is_string()
                ? model::encode_control_text(model, service.letter, command.get_ref<const std::string&>())
                : model::encode_control_json(model, service.letter, command),
            execution.listed[result.size()]);
        if (!line) return fail("commands: number " + std::to_string(result.size() + 1) + ": " + line.error());
        result.push_back(std::move(*line));
    }
    return result;
}

// All lines of a payload are sent, or none.
std::optional<session::Refusal> Control::refusal(const std::vector<Line>& lines, session::ClientId client,
                                                 Time now) const {
    for (const Line& line : lines)
        if (!session::may_be_sent(line.request)) return session::Refusal::kInvalid;
    if (!board_.session.accepts_requests()) return session::Refusal::kNoBoard;
    for (const Line& line : lines)
        if (line.request.line.size() > board_.session.identity().extensions.longest_request())
            return session::Refusal::kTooLong;
    if (board_.session.room(client) < lines.size()) return session::Refusal::kQueueFull;
    const auto names = std::count_if(lines.begin(), lines.end(), [](const Line& line) {
        return session::NameBudget::concerns(line.request.line);
    });
    if (static_cast<std::size_t>(names) > board_.session.names_left(now))
        return session::Refusal::kTooManyNames;
    return std::nullopt;
}

}  // namespace asip::agent
