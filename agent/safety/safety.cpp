// SPDX-License-Identifier: Apache-2.0
#include "agent/safety/safety.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "agent/command/command_note.hpp"
#include "agent/command/error_report.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"
#include "asip/protocol/message.hpp"

namespace asip::agent {

using program::log::Level;

namespace {

// For a stop that has nothing to undo: only an answer of the board shows that it is there.
constexpr const char* kQuestion = "#,?";

std::string milliseconds(Duration time) {
    return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(time).count()) + " ms";
}

// On a service's topic a request stands without its service.
std::string_view without_service(std::string_view line) {
    return line.size() > 2 ? line.substr(2) : line;
}

}  // namespace

std::string safe_form_of(const session::ServiceTable& services, const protocol::Request& request) {
    const auto* service = services.find(request.service);
    if (service == nullptr || !service->model) return {};
    const auto* command = service->model->command_with_tag(request.tag);
    if (command == nullptr || !command->safe) return {};
    const auto encoded = model::encode_text_command(*service->model, without_service(request.line));
    return encoded ? encoded->safe : std::string();
}

// --- commands

void Safety::queued(session::RequestId id, std::string_view line, const std::string& safe) {
    if (safe.empty()) {
        if (holds_.holds(line)) requests_.emplace(id, line);
        return;
    }
    requests_.emplace(id, safe);
    const auto* service = board_.services.find(safe[0]);
    if (service != nullptr && service->model && service->model->safe.empty()) outputs_.queued(safe);
}

void Safety::on_finished(const session::Finished& end, Time now, Effects& out) {
    if (const auto request = requests_.find(end.id); request != requests_.end()) {
        holds_.on_finished(end, request->second);
        outputs_.on_finished(end, request->second);
        requests_.erase(request);
    }
    std::vector<SafeLines::Done> lines;
    lines_.on_finished(end, lines);
    for (const auto& line : lines)
        done(line, now, out);
}

void Safety::done(const SafeLines::Done& line, Time now, Effects& out) {
    if (line.executed) values_.executed(line.sent, now);
    if (const auto hold = expired_.find(line.line); hold != expired_.end()) {
        report(hold->second,
               "not renewed within " + milliseconds(hold->second.length) + "; " + line.sent +
                   (line.executed ? " was executed" : " was refused by the board: " + line.text),
               out);
        expired_.erase(hold);
    }
    for (OpenStop& stop : stops_) {
        if (stop.open.erase(line.line) == 0) continue;
        if (line.executed) {
            if (line.line != kQuestion) stop.executed.push_back(line.sent);
        } else if (!stop.error) {
            stop.error = line;
        }
        if (stop.open.empty()) answer(stop, true, now, out);
    }
    std::erase_if(stops_, [](const OpenStop& stop) { return stop.open.empty(); });
}

void Safety::report(const Holds::Hold& hold, const std::string& text, Effects& out) {
    out.log(Level::kWarning, "hold not renewed: command undone",
            {{"command", hold.line}, {"why", text}, {"by", hold.by}});
    report_failure(board_, {hold.service, without_service(hold.line), "not-renewed", text, hold.by}, out);
    bus::Reply outcome = bus::Reply::timeout();
    outcome.error = text;
    note_command(board_, {"undone", hold.service, without_service(hold.line), hold.by, outcome}, out);
}

// --- the board

void Safety::board_restarted(Effects& out) {
    for (const auto& hold : holds_.take_all()) {
        board_.session.will_execute(wire(hold.safe));
        report(hold, "the board restarted; it has no holds any more", out);
    }
    for (const auto& [safe, hold] : expired_)
        report(hold, "not renewed within " + milliseconds(hold.length) + "; the board restarted", out);
    expired_.clear();
    outputs_.board_restarted();
    for (const auto& line : board_.session.levels())
        if (const auto write = protocol::parse_request(line))
            outputs_.queued(safe_form_of(board_.services, *write));
}

void Safety::make_safe(const std::string& line) {
    lines_.add(line);
    board_.session.will_execute(wire(line));
}

std::string Safety::wire(const std::string& safe) const {
    return values_.low_is_on(safe) ? safe.substr(0, safe.size() - 1) + "1" : safe;
}

void Safety::send(Time now, session::Actions& actions) {
    lines_.send(board_.session, now, actions, [this](const std::string& safe) { return wire(safe); });
}

void Safety::board_gone(Effects& out) {
    for (const auto& hold : holds_.take_all()) {
        make_safe(hold.safe);
        report(hold, "the board is not there; " + wire(hold.safe) + " is sent as soon as it is back", out);
    }
}

void Safety::stop_services() {
    for (const auto& service : board_.services.entries())
        if (service.model)
            for (const auto& line : service.model->safe)
                make_safe(line);
}

// --- the bus

void Safety::on_stop(const Stop& message, Time now, session::Actions& actions, Effects& out) {
    OpenStop stop;
    stop.reply = message.reply();
    stop.asker = bus::asker_of(stop.reply.topic);
    stop.latched = message.latch;
    stop.arrived = now;
    stop.deadline =
        now + (message.envelope.deadline ? Duration(*message.envelope.deadline) : session::kDefaultDeadline);
    if (message.retained) {
        const auto refused = bus::Reply::refused(
            std::string(bus::kRefusedRetained),
            "a stored stop was not executed; clear it by publishing an empty retained message on " +
                message.topic);
        if (auto reply = bus::reply_message(stop.reply, refused))
            out.publish.push_back({std::move(*reply), mqtt::Priority::kUrgent});
        return;
    }
    statistics_.stopped();
    if (stops_.empty())
        out.log(Level::kWarning, "stopped by a message", {{"topic", message.topic}, {"by", stop.reply.by}});
    std::vector<std::string> lines = outputs_.lines();
    for (const auto& hold : holds_.take_all())
        lines.push_back(hold.safe);
    for (const auto& service : board_.services.entries())
        if (service.model) lines.insert(lines.end(), service.model->safe.begin(), service.model->safe.end());
    if (lines.empty()) lines.emplace_back(kQuestion);
    for (const auto& line : lines)
        make_safe(line);
    send(now, actions);
    stop.refused = message.waiting;
    stop.open.insert(lines.begin(), lines.end());
    const auto of_asker = std::count_if(stops_.begin(), stops_.end(),
                                        [&](const OpenStop& other) { return other.asker == stop.asker; });
    if (stops_.size() >= kMaxStops || std::cmp_greater_equal(of_asker, kMaxStopsOfAsker))
        return answer(stop, false, now, out);
    stops_.push_back(std::move(stop));
}

void Safety::refuse_waiting(session::Actions& actions) {
    const auto refused = board_.session.cancel_waiting(actions);
    if (!stops_.empty()) stops_.back().refused += refused;
}

void Safety::answer(const OpenStop& stop, bool in_time, Time now, Effects& out) {
    bus::Reply reply = bus::Reply::ok("fence");
    if (!in_time) {
        reply = bus::Reply::timeout(bus::kTimeoutBoardNotThere);
        reply.error = "the board did not confirm it; it is stopped as soon as it answers";
    } else if (stop.error) {
        reply = bus::Reply::board_error(stop.error->code, stop.error->sent + ": " + stop.error->text);
    }
    nlohmann::json done{{"executed", stop.executed}, {"refused", stop.refused}};
    if (stop.latched) done["latched"] = true;
    reply.answer = model::dump_json(done);
    statistics_.answered(reply, stop.reply.wanted(), now - stop.arrived);
    if (auto message = bus::reply_message(stop.reply, reply))
        out.publish.push_back({std::move(*message), mqtt::Priority::kUrgent});
    if (notes_of_stops_.take(now)) note_command(board_, {"stop", {}, {}, stop.reply.by, reply}, out);
}

bool Safety::release_all() {
    for (const auto& hold : holds_.take_all())
        make_safe(hold.safe);
    return pending();
}

// --- time

void Safety::tick(Time now, Effects& out) {
    for (auto& hold : holds_.take_expired(now)) {
        statistics_.hold_expired();
        make_safe(hold.safe);
        expired_.insert_or_assign(hold.safe, std::move(hold));
    }
    for (const OpenStop& stop : stops_)
        if (now >= stop.deadline) answer(stop, false, now, out);
    std::erase_if(stops_, [&](const OpenStop& stop) { return now >= stop.deadline; });
}

std::optional<Time> Safety::next_deadline() const {
    auto first = holds_.next_deadline();
    for (const OpenStop& stop : stops_)
        if (!first || stop.deadline < *first) first = stop.deadline;
    return first;
}

}  // namespace asip::agent
