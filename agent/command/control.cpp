// SPDX-License-Identifier: Apache-2.0
#include "agent/command/control.hpp"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "agent/command/command_note.hpp"
#include "agent/command/error_report.hpp"
#include "agent/command/refusal_text.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"
#include "asip/protocol/error_code.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/request.hpp"

namespace asip::agent {

namespace {

// Questions whose answer has their own tag; what a raw request is answered with.
char answer_of_question(std::string_view line) {
    const auto request = protocol::parse_request(line);
    return request && session::is_question(request->service, request->tag) ? request->tag : '\0';
}

std::string service_of_line(const session::ServiceTable& services, std::string_view line) {
    return service_named(services, line.size() > 1 && line[1] == ',' ? line[0] : '#');
}

// On a service's topic the request stands without its service.
std::string_view request_of_line(std::string_view line) {
    return line.size() > 2 && line[1] == ',' ? line.substr(2) : line;
}

session::ClientId client_of(const std::string& topic) {
    return std::hash<std::string>{}(topic) | kBusClient;
}

}  // namespace

Time deadline_of(const bus::RequestEnvelope& envelope, const mqtt::Message& message, Time arrived,
                 Time sent) {
    if (!message.expiry_seconds)
        return sent + (envelope.deadline ? Duration(*envelope.deadline) : session::kDefaultDeadline);
    const auto left = std::clamp<std::chrono::milliseconds>(std::chrono::seconds(*message.expiry_seconds),
                                                            bus::kMinDeadline, bus::kMaxDeadline);
    // What is left of the expiry shows how long it was on its way; brokers cut off up to a second.
    return envelope.deadline
               ? std::min<Time>(sent + *envelope.deadline, arrived + left + std::chrono::seconds(1))
               : arrived + left;
}

Time sent_at(std::optional<Time> told, Time arrived) {
    return told ? std::min(*told, arrived) : arrived;
}

namespace {

// `{"renew":"7"}`, unless the service has a command of that name.
bool is_renewal(const bus::RequestEnvelope& envelope, const model::ServiceModel* model) {
    return envelope.form == bus::RequestEnvelope::Form::kJson && envelope.object.contains("renew") &&
           model != nullptr && model->command("renew") == nullptr;
}

}  // namespace

void Control::on_message(const mqtt::Message& message, const Arrival& arrival,
                         const session::ServiceTable& services, session::BoardSession& session, Time now,
                         session::Actions& actions, Effects& out) {
    const auto topic = topics_.parse(message.topic);
    if (!topic) return;
    auto command = std::make_shared<Command>();
    auto envelope = bus::open_envelope(message);
    command->reply = envelope ? envelope->reply : envelope.error().reply;
    command->arrived = arrival.at;
    const auto told = envelope ? clock_.time_of(envelope->sent) : std::nullopt;
    command->sent = sent_at(told, arrival.at);
    command->board = topic->board;
    command->service = topic->service;
    command->noted = envelope ? envelope->shown() : message.payload;
    const auto refuse_it = [&](std::string_view reason, std::string text) {
        refuse(*command, command->noted, reason, std::move(text), now, out);
    };
    if (message.retain)
        return refuse_it(
            bus::kRefusedRetained,
            "a stored command was not executed; clear it by publishing an empty retained message on " +
                message.topic);
    if (!envelope) return refuse_it(bus::kRefusedInvalid, envelope.error().error);

    const bool for_service = topic->kind == bus::TopicKind::kServiceIn;
    const auto* service = for_service ? services.find(topic->service) : nullptr;
    if (service != nullptr) {
        command->model_owner = service->model;
        command->model = service->model.get();
    }
    command->client = client_of(command->reply.wanted() ? command->reply.topic : message.topic);
    const bool renewal = is_renewal(*envelope, command->model);
    if (!renewal && was_seen(*command, message, told, now, out)) return;
    if (arrival.stopped)
        return refuse_it(bus::kRefusedStopped, "the board was stopped while it waited; it was not sent");
    if (for_service && service == nullptr)
        return refuse_it(services.entries().empty() ? bus::kRefusedBoardNotThere : bus::kRefusedInvalid,
                         "the board has no service \"" + std::string(topic->service) + "\"");
    if (renewal) {
        command->noted.clear();
        return renew(*command, *envelope, now, out);
    }
    command->deadline = deadline_of(*envelope, message, arrival.at, command->sent);
    command->hold = envelope->hold;
    // Nobody is there to renew it after that.
    if (command->hold) command->deadline = std::min(command->deadline, command->sent + *command->hold);
    const auto lines = read(*envelope, service, services);
    if (!lines) return refuse_it(bus::kRefusedInvalid, lines.error());
    if (auto fault = hold_fault(*command, *lines); !fault.empty())
        return refuse_it(bus::kRefusedInvalid, std::move(fault));
    if (const auto why = refusal(*lines, command->client, session)) {
        if (service != nullptr) return refuse_it(session::to_string(*why), refusal_text(*why));
        const std::string& line = lines->front().text;
        command->service = service_of_line(services, line);
        return refuse(*command, request_of_line(line), session::to_string(*why), refusal_text(*why), now,
                      out);
    }
    execute(std::move(command), *lines, services, session, now, actions, out);
}

// The same message again is answered as the first was, or when that one is.
bool Control::was_seen(Command& command, const mqtt::Message& message, std::optional<Time> sent, Time now,
                       Effects& out) {
    const std::string id = command.reply.key();
    if (id.empty()) return false;
    const auto key = RecentAnswers::key(message.topic, command.reply.topic, id);
    switch (recent_.see(key, message.payload, now, sent)) {
        case RecentAnswers::Seen::kNew:
            command.key = key;
            return false;
        case RecentAnswers::Seen::kPending:
            break;
        case RecentAnswers::Seen::kAnswered:
            send(command.reply, *recent_.find(key), now, out);
            break;
        case RecentAnswers::Seen::kOtherPayload:
            refuse(command, command.noted, bus::kRefusedIdReused,
                   "another command had this id within the last minute", now, out);
            break;
    }
    return true;
}

std::string Control::hold_fault(const Command& command, const std::vector<Line>& lines) const {
    if (!command.hold) return {};
    if (command.service.empty()) return "only a command on BOARD/SERVICE/in can be held";
    if (lines.front().safe.empty()) return "nothing undoes this command, so it cannot be held";
    if (!safety_.holds().room_for(lines.front().safe))
        return std::to_string(Holds::kMax) + " commands are held on this board already";
    return {};
}

// Has no queue to wait in: the board is not asked.
void Control::renew(Command& command, const bus::RequestEnvelope& envelope, Time now, Effects& out) {
    const auto& which = envelope.object.at("renew");
    std::optional<std::string> id;
    if (which.is_string()) id = which.get<std::string>();
    if (which.is_number()) id = which.dump();
    if (!id && which != nlohmann::json(true))
        return refuse(command, "renew", bus::kRefusedInvalid,
                      "\"renew\" must be the id of a command, or true", now, out);
    const auto count =
        safety_.holds().renew(command.client, command.service, id, envelope.hold, command.sent);
    if (count == 0)
        return refuse(command, "renew", bus::kRefusedNotHeld,
                      "this client holds nothing here: it was not renewed in time, or another command, a "
                      "stop or a restart of the board ended it",
                      now, out);
    command.outcome = bus::Reply::ok("renewed");
    conclude(command, now, out);
}

Expected<std::vector<Control::Line>> Control::read(const bus::RequestEnvelope& envelope,
                                                   const session::ServiceTable::Entry* service,
                                                   const session::ServiceTable& services) const {
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
            result.push_back({std::string(line), answer_of_question(line), session::kDefaultAnswerTime,
                              safe_form_of(services, line)});
        return result;
    }
    const auto* model = service->model.get();
    const auto command = envelope.form == bus::RequestEnvelope::Form::kJson
                             ? model::encode_control_json(model, service->letter, envelope.object)
                             : model::encode_control_text(model, service->letter, envelope.text);
    if (!command) return Unexpected<std::string>(command.error());
    result.push_back({command->line, command->answer});
    result.back().safe = command->safe;
    if (command->answer_time) result.back().answer_time = *command->answer_time;
    return result;
}

// All lines of a payload are sent, or none.
std::optional<session::Refusal> Control::refusal(const std::vector<Line>& lines, session::ClientId client,
                                                 const session::BoardSession& session) const {
    for (const Line& line : lines)
        if (!session::may_be_sent(line.text)) return session::Refusal::kInvalid;
    if (!session.accepts_requests()) return session::Refusal::kNoBoard;
    for (const Line& line : lines)
        if (line.text.size() > session.identity().extensions.longest_request())
            return session::Refusal::kTooLong;
    if (session.room(client) < lines.size()) return session::Refusal::kQueueFull;
    return std::nullopt;
}

void Control::execute(std::shared_ptr<Command> command, const std::vector<Line>& lines,
                      const session::ServiceTable& services, session::BoardSession& session, Time now,
                      session::Actions& actions, Effects& out) {
    command->lines = lines.size();
    const bool wanted = command->reply.wanted();
    for (const Line& line : lines) {
        const auto id = session.submit(line.text,
                                       {.client = command->client,
                                        .deadline = command->deadline,
                                        .prove = wanted,
                                        .answer_tag = wanted ? line.answer_tag : '\0',
                                        .answer_time = line.answer_time,
                                        .is_answer = answer_check(*command)},
                                       now, actions);
        if (!id) {
            ++command->not_sent;
            continue;
        }
        safety_.queued(*id, line.text, line.safe, services);
        periods_.queued(*id, line.text);
        if (command->hold)
            safety_.holds().begin({command->client, command->reply.key(), command->service, line.text,
                                   line.safe, *command->hold, command->sent + *command->hold, *id,
                                   command->reply.by});
        ++command->open;
        open_.emplace(
            *id,
            Open{command, command->service.empty() ? service_of_line(services, line.text) : command->service,
                 line.text});
    }
    command->all_sent = true;
    if (command->open == 0) conclude(*command, now, out);
}

session::AnswerCheck Control::answer_check(const Command& command) const {
    if (!command.model || !command.reply.wanted()) return {};
    return [this, model = command.model_owner](const protocol::Event& event) {
        return model->event(event.tag) == nullptr ||
               model::decode_event(*model, event, decode_context()).has_value();
    };
}

bool Control::on_finished(const session::Finished& end, Time now, Effects& out) {
    const auto it = open_.find(end.id);
    if (it == open_.end()) return false;
    const Open request = std::move(it->second);
    const auto& command = request.command;
    open_.erase(it);
    const auto report = [&](std::string_view reason, std::string_view error) {
        if (!command->reply.wanted())
            report_failure(topics_, command->board,
                           {request.service, request_of_line(request.line), reason, error, command->reply.by},
                           out);
    };
    // The board's own errors are on the error topic already, in the board's words.
    if (end.ending == session::Ending::kTimeout || end.ending == session::Ending::kDoubt)
        report("timeout", "no sign that the board executed it; it may have, or not");
    if (end.ending == session::Ending::kNotSent) report(reason_of(end), not_sent_text(end));
    note_end(*command, end);
    if (--command->open == 0 && command->all_sent) conclude(*command, now, out);
    return true;
}

// The first that is not good decides.
void Control::note_end(Command& command, const session::Finished& end) const {
    bus::Reply& outcome = command.outcome;
    if (end.ending == session::Ending::kNotSent) ++command.not_sent;
    if (outcome.status != bus::Reply::Status::kOk) return;
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
            outcome = bus::Reply::refused(std::string(reason_of(end)), not_sent_text(end));
            break;
        case session::Ending::kExecuted:
        case session::Ending::kUnproven:
            if (!end.answer.empty()) outcome = bus::Reply::ok("answer", answer_json(command, end.answer));
            break;
    }
}

model::DecodeContext Control::decode_context() const {
    const auto& identity = session_.identity();
    return {&identity.port_map, identity.pin_modes};
}

std::string Control::answer_json(const Command& command, const protocol::ParsedLine& line) const {
    if (command.model) {
        const auto value = model::decode_event(*command.model, line.event(), decode_context());
        if (value) return model::dump_json(*value);
    }
    return model::dump_json(nlohmann::json(line.text()));
}

std::string Control::sender_of(session::ClientId client) const {
    std::optional<std::string> by;
    for (const auto& [id, open] : open_) {
        if (open.command->client != client) continue;
        if (by && *by != open.command->reply.by) return {};
        by = open.command->reply.by;
    }
    return by.value_or(std::string());
}

void Control::refuse(Command& command, std::string_view request, std::string_view reason, std::string text,
                     Time now, Effects& out) {
    out.log(program::log::Level::kDebug, "command refused", {{"reason", std::string(reason)}, {"why", text}});
    // An empty payload is how somebody clears a stored command: nothing was asked for.
    if (!command.reply.wanted() && !request.empty())
        report_failure(
            topics_, command.board,
            {command.service.empty() ? "io" : command.service, request, reason, text, command.reply.by}, out);
    command.outcome = bus::Reply::refused(std::string(reason), std::move(text));
    conclude(command, now, out);
}

void Control::report_refused(const std::string& board, std::string_view line, session::Refusal why,
                             const session::ServiceTable& services, Effects& out) const {
    report_failure(topics_, board,
                   {service_of_line(services, line),
                    request_of_line(line),
                    session::to_string(why),
                    refusal_text(why),
                    {}},
                   out);
}

void Control::conclude(Command& command, Time now, Effects& out) {
    // "Refused" is only what was not executed at all, and an error one of all lines.
    if (command.not_sent > 0 && command.not_sent < command.lines) {
        const std::string why = std::move(command.outcome.error);
        command.outcome = bus::Reply::timeout(bus::kTimeoutPartly);
        command.outcome.error = std::to_string(command.not_sent) + " of " + std::to_string(command.lines) +
                                " lines were not sent: " + why;
    }
    if (command.key) recent_.answer(*command.key, command.outcome);
    statistics_.answered(command.outcome, command.reply.wanted(), now - command.arrived);
    send(command.reply, command.outcome, now, out);
    if (!command.noted.empty())
        note_command(topics_, command.board,
                     {"command", command.service, command.noted, command.reply.by, command.outcome,
                      command.reply.wanted()},
                     out);
}

void Control::send(const bus::ReplyTo& to, bus::Reply reply, Time now, Effects& out) const {
    if (to.clock) reply.clock = clock_.read(now);
    if (auto message = bus::reply_message(to, std::move(reply)))
        out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
}

}  // namespace asip::agent
