// SPDX-License-Identifier: Apache-2.0
// The bus's side of the bridge: messages and point-to-point clients, and the port while it is lent.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "agent/bridge/bridge.hpp"
#include "agent/command/command_note.hpp"
#include "asip/bus/request/line_service.hpp"
#include "asip/program/options.hpp"
#include "asip/protocol/message.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::agent {

using program::log::Level;

namespace {

std::string error_line(char service, char tag, protocol::ErrorCode code) {
    return std::string{'~', service, ',', tag, ','} + std::to_string(static_cast<int>(code)) + "{" +
           std::string(protocol::error_name(code)) + "}";
}

/// As the board itself answers to what is no request: under the letter that it begins with.
std::string error_to_no_request(std::string_view line, const session::Identity& board) {
    const auto shown = [line](std::size_t at) {
        return at < line.size() && line[at] > ' ' && line[at] <= '~' ? line[at] : '?';
    };
    const char first = shown(0);
    const bool known = first == '#' || board.find_service(first) != nullptr;
    return error_line(first, known && shown(1) == ',' ? shown(2) : '?',
                      known ? protocol::ErrorCode::kUnknownRequest : protocol::ErrorCode::kInvalidService);
}

}  // namespace

std::vector<member::Announcer::Subscription> Bridge::subscriptions() const {
    return announcer_->subscriptions();
}

// Demands and requests for links are not acknowledged: a flood of them would take the places of commands
// among the few messages that a broker has under way. The agent does without requests for links, and without
// what agents of before left, where the broker refuses them.
std::vector<member::Announcer::Subscription> Bridge::control_subscriptions() const {
    const auto& topics = board_.topics;
    const mqtt::SubscribeOptions commands{.qos = 1, .no_local = true, .required = true};
    std::vector<member::Announcer::Subscription> result{{topics.board_in(name()), commands},
                                                        {topics.service_in(name(), "+"), commands}};
    if (options_.context.client_side) result.push_back({topics.board_out(name()), commands});
    result.push_back({topics.demand(name(), "+/+"), {.no_local = true, .required = true}});
    // A board's user may not write there: what is retained cannot be cleared by its agent.
    result.push_back({topics.link(name(), "+/+"), {.no_local = true, .retained = false}});
    result.push_back({topics.service_set(name(), "+"), {.no_local = true}});
    return result;
}

void Bridge::bus_connected(Time now, const std::string& client_id, bool expires, Effects& out) {
    if (!announcer_) return;
    age_.connection_changed();
    if (describer_.note_agent({ASIP_VERSION, program::host_name(), client_id})) describe_again(now);
    announcer_->on_connected(now, out, expires);
    start_publishing(out);
    values_.connected(now);
    links_.connected(now);
    run_links(now, out);
}

void Bridge::bus_subscribed(Time now, Effects& out) {
    if (announcer_ && name_claimed_) announcer_->on_subscribed(now, out);
    publish_values(now, out);
}

void Bridge::bus_disconnected() {
    age_.connection_changed();
    if (announcer_) announcer_->on_disconnected();
}

// --- messages

std::optional<Inbound> Bridge::read(const mqtt::Message& message, Time now) const {
    if (!announcer_ || leaving_) return std::nullopt;
    return read_inbound(message,
                        {.topics = board_.topics,
                         .board = board_.name,
                         .services = board_.services,
                         .client_side = options_.context.client_side},
                        age_, now);
}

void Bridge::take(const Inbound& message, Time now, Effects& out) {
    if (leaving_) return;
    // Until then another agent may be meant.
    if (request_of(message) != nullptr && !announcer_->established()) return;
    std::visit([&](const auto& known) { on_message(known, now, out); }, message);
    run_links(now, out);
}

void Bridge::on_message(const Command& command, Time now, Effects& out) {
    session::Actions actions;
    control_.on_command(command, now, actions, out);
    perform(actions, now, out);
}

void Bridge::on_message(const Renewal& renewal, Time now, Effects& out) {
    control_.on_renewal(renewal, now, out);
}

bool Bridge::obeys(const Stop& stop) const {
    const auto sent = stop.arrival.told;
    return !stop.retained &&
           !(sent && resumed_ && same_client(stop, *resumed_) && *sent < *resumed_->arrival.told);
}

void Bridge::on_message(const Stop& stop, Time now, Effects& out) {
    const bool obeyed = obeys(stop);
    if (!obeyed && !stop.retained) {
        const auto reply =
            bus::Reply::refused(std::string(bus::kRefusedDeadline),
                                "the board was resumed after this stop was sent; stop it again");
        if (auto message = bus::reply_message(stop.reply(), reply))
            out.publish.push_back({std::move(*message), mqtt::Priority::kUrgent});
        return;
    }
    session::Actions actions;
    safety_.on_stop(stop, now, actions, out);
    if (obeyed) links_.stopped(stop.latch);
    if (stop.latch && obeyed && latch_.stop(stop.reply().by, stop.why, text::iso_time(text::wall_now()))) {
        out.keep_stop = latch_.stopped();
        show_stop(now, out);
    }
    perform(actions, now, out);
    out.stopped = obeyed;
}

void Bridge::refuse_waiting(Time now, Effects& out) {
    session::Actions actions;
    safety_.refuse_waiting(actions);
    perform(actions, now, out);
}

void Bridge::on_message(const Resume& resume, Time now, Effects& out) {
    const bool late = now > resume.deadline();
    auto reply = bus::Reply::ok("resumed");
    if (resume.retained)
        reply = bus::Reply::refused(
            std::string(bus::kRefusedRetained),
            "a stored request resumes nothing; clear it by publishing an empty retained message on " +
                resume.topic);
    else if (late)
        reply = bus::Reply::refused(std::string(bus::kRefusedDeadline), "it came too late; send it again");
    else if (resume.envelope.object.value("resume", nlohmann::json()) != nlohmann::json(true))
        reply = bus::Reply::refused(std::string(bus::kRefusedInvalid), "write {\"resume\":true}");
    if (reply.succeeded() && resume.arrival.told) {
        resumed_ = resume;
        resumed_->arrival.told = std::min(*resume.arrival.told, now);  // a sender may tell any time
    }
    const bool resumed = reply.succeeded() && latch_.resume();
    if (resumed) {
        links_.resumed();
        out.keep_stop = std::optional<model::StopInfo>();
        out.log(Level::kWarning, "resumed", {{"by", resume.reply().by}});
        show_stop(now, out);
    }
    if (auto message = bus::reply_message(resume.reply(), reply))
        out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
    if (resumed) note_command(board_, {"resumed", {}, {}, resume.reply().by, reply}, out);
}

void Bridge::on_message(const LabelRequest& request, Time now, Effects& out) {
    labels_.request(request, now, out);
    if (describer_.note_labels(labels_)) describe_again(now);
}

void Bridge::on_message(const DemandMessage& demand, Time now, Effects& out) {
    const auto wanted = bus::parse_demand(demand.payload);
    periods_.demand(demand.demander, wanted, now);
    if (wanted && wanted->services.contains(std::string(bus::kLineService)))
        context_.line().watch_until(now + wanted->lease);
    if (wanted && !wanted->reply_to.empty() && may_publish())
        values_.answer(demand.demander, *wanted, announcer_->session(), now, out);
    send_periods(now, out);
}

/// However many there are, they take no place in the queue that an announcement or an answer needs.
void Bridge::on_message(const Leftover& left, Time, Effects& out) {
    out.publish.push_back({member::retained(left.topic), mqtt::Priority::kContext});
}

void Bridge::on_message(const Announcement& announcement, Time now, Effects& out) {
    const auto& message = announcement.message;
    announcer_->on_message(message, now, out);
    if (message.payload.empty() && message.topic != board_.topics.probe()) values_.emptied(now);
    yield_name(out);
}

void Bridge::labels_kept(const Expected<std::filesystem::path>& result, Time now, Effects& out) {
    labels_.kept(result, now, out);
    if (describer_.note_labels(labels_)) describe_again(now);
}

// --- the port

BoardTraits Bridge::traits() const {
    const auto& board = session().identity();
    const auto firmware = describer_.firmware();
    return {firmware.chip, firmware.sketch, board.stored_name, firmware.version, firmware.available};
}

void Bridge::on_message(const PortRequest& request, Time now, Effects& out) {
    const bool ours = port_.phase() == PortLoan::Phase::kOurs;
    port_.request(request, {traits(), describer_.link(), program::host_name(), session().accepts_requests()},
                  now, text::wall_now(), out);
    announcer_->set_updating(port_.updating());
    if (ours && port_.phase() == PortLoan::Phase::kMakingSafe) {
        rests_until_.reset();
        release_holds(now, out);
        tick_port(now, out);
    }
}

void Bridge::loading(std::string_view step, int percent) {
    port_.loading(step, percent);
    announcer_->set_updating(port_.updating());
}

void Bridge::loaded(const Expected<void>& result, Time now, Effects& out) {
    port_.loaded(result, now, out);
    announcer_->set_updating(port_.updating());
    if (!result) announcer_->set_state(model::BoardState::kLost, model::StateReason::kSilent, now, out);
}

// A port where nothing answers may be another program's in between: the IDE's, for one.
void Bridge::rest(Time now, Effects& out) {
    if (port_.phase() != PortLoan::Phase::kOurs) return;
    session::Actions actions;
    board_.session.link_down(now, actions);
    perform(actions, now, out);
    rests_until_ = now + kRest;
    out.port = Effects::Port::kLetGo;
}

void Bridge::tick_port(Time now, Effects& out) {
    if (rests_until_ && now >= *rests_until_) {
        rests_until_.reset();
        out.port = Effects::Port::kTakeBack;
    }
    if (port_.phase() == PortLoan::Phase::kMakingSafe && is_safe()) {
        leave_line(now, out);
        if (has_left_line()) return let_go_of_port(now, out);
    }
    const auto before = port_.phase();
    const bool silent = port_.tick(now, out);
    if (before == PortLoan::Phase::kMakingSafe && port_.is_away()) return let_go_of_port(now, out);
    if (!announcer_) return;
    announcer_->set_updating(port_.updating());
    if (silent) announcer_->set_state(model::BoardState::kLost, model::StateReason::kSilent, now, out);
}

void Bridge::let_go_of_port(Time now, Effects& out) {
    announcer_->set_state(model::BoardState::kUpdating, model::StateReason::kReleased, now, out);
    safety_.board_gone(out);
    session::Actions actions;
    board_.session.link_down(now, actions);
    perform(actions, now, out);
    values_.away();
    port_.let_go(now, out);
    announcer_->set_updating(port_.updating());
}

// --- point-to-point clients

Bridge::ClientResult Bridge::client_line(session::ClientId client, std::string_view line,
                                         std::optional<Time> sent, Time now, Effects& out) {
    auto& session = board_.session;
    const auto request = protocol::parse_request(line);
    const bool valid = request && session::may_be_sent(*request);
    if (valid && latch_.holds(board_.services, *request)) {
        out.lines.push_back(
            {error_line(request->service, request->tag, protocol::ErrorCode::kDeviceNotAvailable), client});
        if (may_publish()) control_.report_refused(line, now, out);
        return ClientResult::kRefused;
    }
    if (valid && session.accepts_requests() && session.waiting(client) >= kMaxClientLines)
        return ClientResult::kLater;
    auto why = session::Refusal::kInvalid;
    if (valid) {
        session::Actions actions;
        auto options = client_requests_.options(client, *request, session.identity());
        if (sent) options.deadline = *sent + session::kDefaultDeadline;
        const auto id = session.submit(*request, options, now, actions);
        if (id) {
            client_requests_.sent(*id, client);
            safety_.queued(*id, line, safe_form_of(board_.services, *request));
            periods_.queued(*id, *request);
            values_.queued(*id, line);
        }
        perform(actions, now, out);
        if (id) return ClientResult::kAccepted;
        why = id.error();
    }
    const bool not_there = valid && why != session::Refusal::kTooLong;
    const auto code =
        not_there ? protocol::ErrorCode::kDeviceNotAvailable : protocol::ErrorCode::kUnknownRequest;
    out.lines.push_back({request ? error_line(request->service, request->tag, code)
                                 : error_to_no_request(line, session.identity()),
                         client});
    if (may_publish()) control_.report_refused(line, why, now, out);
    return ClientResult::kRefused;
}

}  // namespace asip::agent
