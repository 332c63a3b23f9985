#include "agent/control.hpp"

#include <nlohmann/json.hpp>

#include "agent/error_report.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"
#include "asip/protocol/error_code.hpp"
#include "asip/protocol/request.hpp"

namespace asip::agent {

namespace {

// Questions whose answer has their own tag; what a raw request is answered with.
char answer_of_question(std::string_view line) {
    const auto request = protocol::parse_request(line);
    if (!request) return 0;
    const std::string_view tags = request->service == '#' ? "?NSXIE" : request->service == 'I' ? "Mmpc" : "";
    return tags.find(request->tag) == std::string_view::npos ? '\0' : request->tag;
}

std::string service_of_line(const session::ServiceTable& services, std::string_view line) {
    return service_named(services, line.size() > 1 && line[1] == ',' ? line[0] : '#');
}

// On a service's topic the request stands without its service.
std::string_view request_of_line(std::string_view line) {
    return line.size() > 2 && line[1] == ',' ? line.substr(2) : line;
}

std::string refusal_text(session::Refusal refusal) {
    switch (refusal) {
        case session::Refusal::kQueueFull:
            return "too many commands wait for the board; send fewer, or wait for answers";
        case session::Refusal::kNoBoard:
            return "the board is not there now";
        case session::Refusal::kInvalid:
            return "not a request that may be sent to the board";
    }
    return {};
}

}  // namespace

void Control::on_message(const mqtt::Message& message, const session::ServiceTable& services,
                         session::BoardSession& session, Time now, session::Actions& actions, Effects& out) {
    const auto topic = topics_.parse(message.topic);
    if (!topic || (topic->kind != bus::TopicKind::kBoardIn && topic->kind != bus::TopicKind::kServiceIn))
        return;
    ++counters_.commands;
    auto command = std::make_shared<Command>();
    auto envelope = bus::open_envelope(message);
    command->reply = envelope ? envelope->reply : envelope.error().reply;
    command->board = topic->board;
    command->service = topic->service;
    const std::string request = envelope ? envelope->shown() : message.payload;
    if (message.retain)
        return refuse(
            *command, request, bus::kRefusedRetained,
            "a stored command was not executed; clear it by publishing an empty retained message on " +
                message.topic,
            out);
    if (!envelope) return refuse(*command, request, bus::kRefusedInvalid, envelope.error().error, out);

    const session::ServiceTable::Entry* service = nullptr;
    if (topic->kind == bus::TopicKind::kServiceIn) {
        service = services.find(topic->service);
        if (!service)
            return refuse(*command, request,
                          services.entries().empty() ? bus::kRefusedBoardNotThere : bus::kRefusedInvalid,
                          "the board has no service \"" + std::string(topic->service) + "\"", out);
        command->model_owner = service->model;
        command->model = service->model.get();
    }
    const std::string id = command->reply.key();
    if (!id.empty()) command->key = command->reply.topic + '\n' + id;
    if (!command->key.empty()) {
        const auto seen = recent_.see(command->key, now);
        if (seen != RecentAnswers::Seen::kNew) ++counters_.repeated;
        if (seen == RecentAnswers::Seen::kAnswered)
            return send(command->reply, *recent_.find(command->key), out);
        if (seen == RecentAnswers::Seen::kPending) return;
    }
    const auto lines = read(*envelope, service);
    if (!lines) return refuse(*command, request, bus::kRefusedInvalid, lines.error(), out);
    execute(std::move(command), *lines, services, session, now, actions, out);
}

Expected<std::vector<Control::Line>> Control::read(const bus::RequestEnvelope& envelope,
                                                   const session::ServiceTable::Entry* service) const {
    std::vector<Line> result;
    if (!service) {
        if (envelope.form != bus::RequestEnvelope::Form::kRaw)
            return fail(
                "ASIP request lines are expected here, or {\"raw\":\"...\"}; JSON commands go to "
                "BOARD/SERVICE/in");
        const auto lines = protocol::split_requests(envelope.text);
        if (!lines) return Unexpected<std::string>(lines.error());
        if (lines->empty()) return fail("no request");
        for (auto line : *lines)
            result.push_back({std::string(line), answer_of_question(line)});
        return result;
    }
    const auto* model = service->model.get();
    const auto command = envelope.form == bus::RequestEnvelope::Form::kJson
                             ? model::encode_control_json(model, service->letter, envelope.object)
                             : model::encode_control_text(model, service->letter, envelope.text);
    if (!command) return Unexpected<std::string>(command.error());
    result.push_back({command->line, command->answer});
    return result;
}

void Control::execute(std::shared_ptr<Command> command, const std::vector<Line>& lines,
                      const session::ServiceTable& services, session::BoardSession& session, Time now,
                      session::Actions& actions, Effects& out) {
    std::size_t number = 0;
    for (const Line& line : lines) {
        ++number;
        const bool wanted = command->reply.wanted();
        const auto id = session.submit(
            line.text, {.prove = wanted, .answer_tag = wanted ? line.answer_tag : '\0'}, now, actions);
        std::string service =
            command->service.empty() ? service_of_line(services, line.text) : command->service;
        if (id) {
            ++command->open;
            open_.emplace(*id, Open{command, std::move(service), line.text});
            continue;
        }
        std::string text = refusal_text(id.error());
        if (lines.size() > 1)
            text = "line " + std::to_string(number) + " of " + std::to_string(lines.size()) + ": " + text;
        ++counters_.refused;
        command->outcome = bus::Reply::refused(session::to_string(id.error()), std::move(text));
        out.log(program::log::Level::kDebug, "command refused",
                {{"reason", command->outcome.reason}, {"line", line.text}});
        if (!wanted)
            report_failure(topics_, command->board, service, request_of_line(line.text),
                           command->outcome.reason, command->outcome.error, out);
        break;
    }
    command->all_sent = true;
    if (command->open == 0) conclude(*command, out);
}

bool Control::on_finished(const session::Finished& end, Effects& out) {
    const auto it = open_.find(end.id);
    if (it == open_.end()) return false;
    const Open request = std::move(it->second);
    const auto& command = request.command;
    open_.erase(it);
    const bool wanted = command->reply.wanted();
    const auto tell = [&](std::string_view reason, std::string_view error) {
        if (!wanted)
            report_failure(topics_, command->board, request.service, request_of_line(request.line), reason,
                           error, out);
    };
    bus::Reply& outcome = command->outcome;
    // The board's own errors are on the error topic already, in the board's words.
    if (end.ending == session::Ending::kTimeout || end.ending == session::Ending::kDoubt)
        tell("timeout", "no sign that the board executed it; it may have, or not");
    if (end.ending == session::Ending::kNotSent)
        tell(bus::kRefusedBoardNotThere, refusal_text(session::Refusal::kNoBoard));
    if (outcome.status == bus::Reply::Status::kOk) {
        switch (end.ending) {
            case session::Ending::kBoardError:
                outcome = bus::Reply::board_error(
                    end.code, end.text.empty() ? std::string(protocol::error_name(end.code)) : end.text);
                break;
            case session::Ending::kDoubt:
                outcome = bus::Reply::timeout(bus::kTimeoutDoubt);
                break;
            case session::Ending::kNoValue:
                outcome = bus::Reply::timeout(bus::kTimeoutNoValue);
                break;
            case session::Ending::kTimeout:
                outcome = bus::Reply::timeout();
                break;
            case session::Ending::kNotSent:
                outcome = bus::Reply::refused(std::string(bus::kRefusedBoardNotThere),
                                              refusal_text(session::Refusal::kNoBoard));
                break;
            case session::Ending::kExecuted:
            case session::Ending::kUnproven:
                if (!end.answer.empty()) outcome.answer = answer_json(*command, end.answer);
                break;
        }
    }
    if (--command->open == 0 && command->all_sent) conclude(*command, out);
    return true;
}

std::string Control::answer_json(const Command& command, const protocol::ParsedLine& line) const {
    if (command.model) {
        const auto& identity = session_.identity();
        const auto value =
            model::decode_event(*command.model, line.event(), {&identity.port_map, identity.pin_modes});
        if (value) return model::dump_json(*value);
    }
    return model::dump_json(nlohmann::json(line.text()));
}

void Control::refuse(Command& command, std::string_view request, std::string_view reason, std::string text,
                     Effects& out) {
    ++counters_.refused;
    out.log(program::log::Level::kDebug, "command refused", {{"reason", std::string(reason)}, {"why", text}});
    // An empty payload is how somebody clears a stored command: nothing was asked for.
    if (!command.reply.wanted() && !request.empty())
        report_failure(topics_, command.board, command.service.empty() ? "io" : command.service, request,
                       reason, text, out);
    command.outcome = bus::Reply::refused(std::string(reason), std::move(text));
    conclude(command, out);
}

void Control::tell_refused(const std::string& board, std::string_view line, session::Refusal why,
                           const session::ServiceTable& services, Effects& out) const {
    report_failure(topics_, board, service_of_line(services, line), request_of_line(line),
                   session::to_string(why), refusal_text(why), out);
}

void Control::conclude(Command& command, Effects& out) {
    if (!command.key.empty()) recent_.answer(command.key, command.outcome);
    send(command.reply, command.outcome, out);
}

void Control::send(const bus::ReplyTo& to, const bus::Reply& reply, Effects& out) {
    if (auto message = bus::reply_message(to, reply))
        out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
}

}  // namespace asip::agent
