// SPDX-License-Identifier: Apache-2.0
#include "agent/bridge/bridge.hpp"
#include "asip/bus/request_envelope.hpp"
#include "asip/program/options.hpp"
#include "asip/protocol/error_code.hpp"
#include "asip/protocol/request.hpp"

namespace asip::agent {

namespace {

std::string error_line(std::string_view request, protocol::ErrorCode code) {
    const auto parsed = protocol::parse_request(request);
    const std::string start = parsed ? std::string{'~', parsed->service, ',', parsed->tag} : "~#,?";
    return start + "," + std::to_string(static_cast<int>(code)) + "{" +
           std::string(protocol::error_name(code)) + "}";
}

}  // namespace

std::vector<member::Announcer::Subscription> Bridge::subscriptions() const {
    return announcer_->subscriptions();
}

std::vector<std::string> Bridge::control_subscriptions() const {
    std::vector<std::string> filters{topics_.stop(name_), topics_.board_in(name_),
                                     topics_.service_in(name_, "+")};
    if (options_.context.client_side) filters.push_back(topics_.board_out(name_));
    if (periods_.on_demand()) filters.push_back(topics_.demand(name_, "+/+"));
    return filters;
}

void Bridge::bus_connected(Time now, const std::string& client_id, bool expires, Effects& out) {
    if (!announcer_) return;
    if (facts_.agent.client != client_id) {
        facts_.agent = {ASIP_VERSION, program::host_name(), client_id};
        describe_again();
    }
    announcer_->on_connected(now, out, expires);
    start_publishing(out);
}

void Bridge::bus_subscribed(Time now, Effects& out) {
    if (announcer_ && name_claimed_) announcer_->on_subscribed(now, out);
}

void Bridge::bus_all_subscribed(Time now) {
    if (announcer_ && name_claimed_) announcer_->on_all_subscribed(now);
}

void Bridge::bus_disconnected() {
    if (announcer_) announcer_->on_disconnected();
}

void Bridge::bus_message(const mqtt::Message& message, const Arrival& arrival, Time now, Effects& out) {
    if (!announcer_) return;
    const auto topic = topics_.parse(message.topic);
    if (!topic) return;
    if (topic->kind == bus::TopicKind::kDemand) {
        if (periods_.on_demand() && topic->board == name_)
            periods_.demand(topic->demander, message.payload, message.retain, now);
        return send_periods(now, out);
    }
    const bool stop = topic->kind == bus::TopicKind::kStop;
    const bool raw = topic->kind == bus::TopicKind::kBoardIn || topic->kind == bus::TopicKind::kBoardOut;
    if (!stop && !raw && topic->kind != bus::TopicKind::kServiceIn)
        return announcer_->on_message(message, now, out);
    if (!announcer_->established()) return;
    session::Actions actions;
    if (stop) {
        safety_.on_stop(message, arrival.waiting, services_, session_, now, actions, out);
        send_safe_lines(now, out);
    } else if ((!raw || (!take_port_request(message, arrival.at.value_or(now), now, out) &&
                         !take_label_request(message, out))) &&
               is_request(topic->kind, message)) {
        control_.on_message(message, {arrival.at.value_or(now), arrival.stopped}, services_, session_, now,
                            actions, out);
    }
    perform(actions, now, out);
}

bool Bridge::is_request(bus::TopicKind kind, const mqtt::Message& message) const {
    const bool client_side = options_.context.client_side;
    if (kind == bus::TopicKind::kBoardOut) return client_side;
    if (!client_side || kind != bus::TopicKind::kBoardIn) return true;
    const auto envelope = bus::open_envelope(message);
    return (envelope ? envelope->reply : envelope.error().reply).wanted();
}

Bridge::ClientResult Bridge::client_line(session::ClientId client, std::string_view line,
                                         std::optional<Time> sent, Time now, Effects& out) {
    const bool valid = session::may_be_sent(line);
    if (valid && session_.accepts_requests() && session_.waiting(client) >= kMaxClientLines)
        return ClientResult::kLater;
    session::Actions actions;
    auto options = client_requests_.options(client, line, session_.identity());
    if (sent) options.deadline = *sent + session::kDefaultDeadline;
    const auto id = session_.submit(line, options, now, actions);
    if (id) client_requests_.sent(*id, client);
    if (id) safety_.queued(*id, line, safe_form_of(services_, line), services_);
    if (id) periods_.queued(*id, line);
    perform(actions, now, out);
    if (id) return ClientResult::kAccepted;
    const bool there = valid && id.error() != session::Refusal::kTooLong;
    const auto code = there ? protocol::ErrorCode::kDeviceNotAvailable : protocol::ErrorCode::kUnknownRequest;
    out.lines.push_back({error_line(line, code), client});
    if (announcer_ && announcer_->may_publish())
        control_.report_refused(name_, line, id.error(), services_, out);
    return ClientResult::kRefused;
}

}  // namespace asip::agent
