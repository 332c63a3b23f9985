// SPDX-License-Identifier: Apache-2.0
// How commands end: answers, reports and notes.
#include <nlohmann/json.hpp>
#include <utility>

#include "agent/command/command_note.hpp"
#include "agent/command/control.hpp"
#include "agent/command/error_report.hpp"
#include "agent/command/refusal_text.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"
#include "asip/protocol/message.hpp"

namespace asip::agent {

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
    note_end(*execution, end);
    if (--execution->open == 0 && execution->all_submitted) conclude(*execution, now, out);
}

// The first that is not good decides.
void Control::note_end(Execution& execution, const session::Finished& end) const {
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
            if (!end.answer.empty()) outcome = bus::Reply::ok("answer", answer_json(execution, end.answer));
            break;
    }
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
