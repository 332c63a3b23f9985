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
#include "asip/protocol/message.hpp"
#include "asip/session/name_budget.hpp"
#include "asip/session/request.hpp"

namespace asip::agent {

namespace {

session::ClientId bus_client(const std::string& name) {
    return std::hash<std::string>{}(name) | kBusClient;
}

}  // namespace

std::shared_ptr<Control::Execution> Control::begin(const BusRequest& request) {
    auto execution = std::make_shared<Execution>();
    execution->reply = request.reply();
    execution->service = request.service;
    execution->noted = request.shown();
    execution->received = request.arrival.received;
    execution->sent = request.arrival.sent();
    execution->deadline = request.deadline();
    execution->hold = request.envelope.hold;
    const auto& client = execution->reply.wanted() ? execution->reply.topic : request.topic;
    execution->client = bus_client(client);
    // After that time its sender cannot renew it any more.
    if (execution->hold)
        execution->deadline = std::min(execution->deadline, execution->sent + *execution->hold);
    return execution;
}

void Control::on_command(const Command& command, Time now, session::Actions& actions, Effects& out) {
    const auto execution = begin(command);
    execution->link = command.link;
    if (!command.link.empty()) execution->client = bus_client("$links");  // one turn for all of them
    const auto refuse_it = [&](std::string_view reason, std::string text) {
        refuse(*execution, execution->noted, reason, std::move(text), now, out);
    };
    if (command.retained)
        return refuse_it(
            bus::kRefusedRetained,
            "a stored command was not executed; clear it by publishing an empty retained message on " +
                command.topic);
    if (!command.fault.empty()) return refuse_it(bus::kRefusedInvalid, command.fault);
    if (was_seen(*execution, command, now, out)) return;
    if (command.stopped)
        return refuse_it(bus::kRefusedStopped, "the board was stopped while it waited; it was not sent");
    const auto refuse_line = [&](std::string_view line, session::Refusal why) {
        execution->service = service_of_line(board_.services, line);
        refuse(*execution, request_of_line(line), session::to_string(why), refusal_text(why), now, out);
    };
    if (const auto line = first_of_too_many(command, *execution); !line.empty())
        return refuse_line(line, session::Refusal::kQueueFull);
    const auto* service = command.service.empty() ? nullptr : board_.services.find(command.service);
    if (!command.service.empty() && service == nullptr)
        return refuse_it(
            board_.services.entries().empty() ? bus::kRefusedBoardNotThere : bus::kRefusedInvalid,
            "the board has no service \"" + command.service + "\"");
    if (service != nullptr) execution->model = service->model;
    const auto lines = read(command, *execution, service);
    if (!lines) return refuse_it(bus::kRefusedInvalid, lines.error());
    for (const Line& line : *lines)
        if (latch_.holds(board_.services, line.request))
            return refuse_it(bus::kRefusedStopped, latch_.why_refused(board_.name));
    if (auto fault = hold_fault(*execution, *lines); !fault.empty())
        return refuse_it(bus::kRefusedInvalid, std::move(fault));
    if (const auto why = refusal(*lines, execution->client, now)) {
        if (service != nullptr) return refuse_it(session::to_string(*why), refusal_text(*why));
        return refuse_line(lines->front().request.line, *why);
    }
    execute(execution, *lines, now, actions, out);
}

// The same message again is answered as the first was, or when that one is.
bool Control::was_seen(Execution& execution, const Command& command, Time now, Effects& out) {
    const std::string id = execution.reply.key();
    if (id.empty()) return false;
    const auto key = RecentAnswers::key(command.topic, execution.reply.topic, id);
    switch (recent_.see(key, command.payload, now, command.arrival.told)) {
        case RecentAnswers::Seen::kNew:
            execution.key = key;
            return false;
        case RecentAnswers::Seen::kPending:
            break;
        case RecentAnswers::Seen::kAnswered:
            send(execution.reply, *recent_.find(key), now, out);
            break;
        case RecentAnswers::Seen::kOtherPayload:
            refuse(execution, execution.noted, bus::kRefusedIdReused,
                   "another command had this id within the last minute", now, out);
            break;
    }
    return true;
}

void Control::on_renewal(const Renewal& renewal, Time now, Effects& out) {
    const auto execution = begin(renewal);
    execution->noted.clear();
    if (!renewal.fault.empty())
        return refuse(*execution, "renew", bus::kRefusedInvalid, renewal.fault, now, out);
    const auto count = safety_.holds().renew(execution->client, execution->service, renewal.id,
                                             execution->hold, execution->sent);
    if (count == 0)
        return refuse(*execution, "renew", bus::kRefusedNotHeld,
                      "this client holds nothing here: it was not renewed in time, or another command, a "
                      "stop or a restart of the board ended it",
                      now, out);
    execution->outcome = bus::Reply::ok("renewed");
    conclude(*execution, now, out);
}

void Control::execute(const std::shared_ptr<Execution>& execution, const std::vector<Line>& lines, Time now,
                      session::Actions& actions, Effects& out) {
    execution->lines = lines.size();
    const bool wanted = execution->is_proven();
    std::size_t place = 0;
    for (const Line& line : lines) {
        const bool more_follow = execution->is_list && ++place < lines.size();
        const auto id = board_.session.submit(line.request,
                                              {.client = execution->client,
                                               .deadline = execution->deadline,
                                               .prove = wanted,
                                               .answer_tag = wanted ? line.answer_tag : '\0',
                                               .answer_time = line.answer_time,
                                               .more_follow = more_follow,
                                               .is_answer = answer_check(*execution)},
                                              now, actions);
        if (!id) {
            ++execution->not_sent;
            continue;
        }
        std::string text(line.request.line);
        safety_.queued(*id, text, line.safe);
        periods_.queued(*id, line.request);
        values_.queued(*id, text);
        if (execution->hold)
            safety_.holds().begin({execution->client, execution->reply.key(), execution->service, text,
                                   line.safe, *execution->hold, execution->sent + *execution->hold, *id,
                                   execution->reply.by});
        ++execution->open;
        auto service =
            execution->service.empty() ? service_of_line(board_.services, text) : execution->service;
        open_.emplace(*id, Open{execution, std::move(service), std::move(text), place});
    }
    execution->all_submitted = true;
    if (execution->open == 0) conclude(*execution, now, out);
}

session::AnswerCheck Control::answer_check(const Execution& execution) const {
    if (!execution.model || !execution.reply.wanted()) return {};
    return [this, model = execution.model](const protocol::Event& event) {
        return model->event(event.tag) == nullptr ||
               model::decode_event(*model, event, decode_context()).has_value();
    };
}

void Control::on_finished(const session::Finished& end, Time now, Effects& out) {
    const auto it = open_.find(end.id);
    if (it == open_.end()) return;
    const Open request = std::move(it->second);
    const auto& execution = request.execution;
    open_.erase(it);
    const auto report = [&](std::string_view reason, std::string_view error) {
        if (!execution->reply.wanted())
            report_failure(
                board_, {request.service, request_of_line(request.line), reason, error, execution->reply.by},
                out);
    };
    // The board's own errors are on the error topic already, in the board's words.
    if (end.ending == session::Ending::kTimeout || end.ending == session::Ending::kDoubt)
        report("timeout", "no sign that the board executed it; it may have, or not");
    if (end.ending == session::Ending::kNotSent) report(reason_of(end), not_sent_text(end));
    note_end(*execution, request.place, end);
    if (--execution->open == 0 && execution->all_submitted) conclude(*execution, now, out);
}

// The first that is not good decides.
void Control::note_end(Execution& execution, std::size_t place, const session::Finished& end) const {
    bus::Reply& outcome = execution.outcome;
    if (end.ending == session::Ending::kNotSent) ++execution.not_sent;
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
            if (end.answer.empty()) break;
            if (execution.is_list)
                execution.answers[place - 1] = answer_json(execution, end.answer);
            else
                outcome = bus::Reply::ok("answer", answer_json(execution, end.answer));
            break;
    }
}

model::DecodeContext Control::decode_context() const {
    const auto& identity = board_.session.identity();
    return {&identity.port_map, identity.pin_modes};
}

std::string Control::answer_json(const Execution& execution, const protocol::ParsedLine& line) const {
    if (execution.model) {
        const auto value = model::decode_event(*execution.model, line.event(), decode_context());
        if (value) return model::dump_json(*value);
    }
    return model::dump_json(nlohmann::json(line.text()));
}

std::string Control::sender_of(session::ClientId client) const {
    std::optional<std::string> by;
    for (const auto& [id, open] : open_) {
        if (open.execution->client != client) continue;
        if (by && *by != open.execution->reply.by) return {};
        by = open.execution->reply.by;
    }
    return by.value_or(std::string());
}

void Control::refuse(Execution& execution, std::string_view request, std::string_view reason,
                     std::string text, Time now, Effects& out) {
    out.log(program::log::Level::kDebug, "command refused", {{"reason", std::string(reason)}, {"why", text}});
    // An empty payload clears a stored command: nothing was asked for.
    const bool reported = !execution.reply.wanted() && !request.empty();
    if ((reported || !execution.reply.by.empty()) && !refusals_.take(now))
        execution.noted.clear();
    else if (reported)
        report_failure(board_,
                       {execution.service.empty() ? "io" : execution.service, request, reason, text,
                        execution.reply.by, refusals_.take_dropped()},
                       out);
    execution.outcome = bus::Reply::refused(std::string(reason), std::move(text));
    conclude(execution, now, out);
}

void Control::report_refused(std::string_view line, session::Refusal why, Time now, Effects& out) {
    report(line, session::to_string(why), refusal_text(why), now, out);
}

void Control::report_refused(std::string_view line, Time now, Effects& out) {
    report(line, bus::kRefusedStopped, latch_.why_refused(board_.name), now, out);
}

void Control::report(std::string_view line, std::string_view reason, std::string_view error, Time now,
                     Effects& out) {
    if (!refusals_.take(now)) return;
    const auto service = service_of_line(board_.services, line);
    report_failure(board_, {service, request_of_line(line), reason, error, {}, refusals_.take_dropped()},
                   out);
}

void Control::conclude(Execution& execution, Time now, Effects& out) {
    // "Refused" is only what was not executed at all, and an error one of all lines.
    if (execution.not_sent > 0 && execution.not_sent < execution.lines) {
        const std::string why = std::move(execution.outcome.error);
        execution.outcome = bus::Reply::timeout(bus::kTimeoutPartly);
        execution.outcome.error = std::to_string(execution.not_sent) + " of " +
                                  std::to_string(execution.lines) + " lines were not sent: " + why;
    }
    if (execution.is_list && execution.outcome.status == bus::Reply::Status::kOk) {
        std::string all;
        for (const auto& answer : execution.answers)
            if (!answer.empty()) all += (all.empty() ? "" : ",") + answer;
        if (!all.empty()) execution.outcome = bus::Reply::ok("answer", "[" + all + "]");
    }
    if (execution.key) recent_.answer(*execution.key, execution.outcome);
    statistics_.answered(execution.outcome, execution.reply.wanted(), now - execution.received);
    send(execution.reply, execution.outcome, now, out);
    if (!execution.noted.empty())
        note_command(board_,
                     {"command", execution.service, execution.noted, execution.reply.by, execution.outcome,
                      execution.is_proven()},
                     out);
    if (!execution.link.empty()) outcomes_.emplace_back(execution.link, execution.outcome);
}

std::string Control::link_of(session::RequestId id) const {
    const auto open = open_.find(id);
    return open == open_.end() ? std::string() : open->second.execution->link;
}

void Control::send(const bus::ReplyTo& to, bus::Reply reply, Time now, Effects& out) const {
    if (to.clock) reply.clock = age_.clock(now);
    if (auto message = bus::reply_message(to, std::move(reply)))
        out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
}

}  // namespace asip::agent
