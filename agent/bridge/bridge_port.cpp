// SPDX-License-Identifier: Apache-2.0
// Letting go of the board's port for somebody else, and taking it back.
#include "agent/bridge/bridge.hpp"
#include "asip/bus/request_envelope.hpp"
#include "asip/program/options.hpp"

namespace asip::agent {

BoardTraits Bridge::traits() const {
    const auto& board = session_.identity();
    return {board.info.chip, board.info.sketch, board.stored_name};
}

bool Bridge::take_port_request(const mqtt::Message& message, Time arrival, Time now, Effects& out) {
    if (message.retain || message.payload.find("\"port\"") == std::string::npos) return false;
    const auto envelope = bus::open_envelope(message);
    if (!envelope || envelope->form != bus::RequestEnvelope::Form::kJson ||
        !bus::is_port_request(envelope->object))
        return false;
    const auto answer = [&](bus::Reply reply) {
        if (auto answered = bus::reply_message(envelope->reply, std::move(reply)))
            out.publish.push_back({std::move(*answered), mqtt::Priority::kReply});
        return true;
    };
    const auto request = bus::read_port_request(envelope->object);
    if (!request) return answer(bus::Reply::refused(std::string(bus::kRefusedInvalid), request.error()));
    // Nobody waits for the port any more, and nobody would give it back.
    if (request->what == bus::PortRequest::What::kRelease &&
        now >= deadline_of(*envelope, message, arrival, sent_at(clock_.time_of(envelope->sent), arrival)))
        return answer(bus::Reply::timeout());
    const bool ready = session_.accepts_requests();
    const bool was_ours = port_.phase() == PortLoan::Phase::kOurs;
    port_.request(*request, envelope->reply, {traits(), facts_.link, program::host_name(), ready}, now,
                  text::wall_now(), out);
    announcer_->set_updating(port_.updating());
    if (was_ours && port_.phase() == PortLoan::Phase::kMakingSafe) {
        release_holds(now, out);
        tick_port(now, out);
    }
    return true;
}

void Bridge::tick_port(Time now, Effects& out) {
    if (port_.phase() == PortLoan::Phase::kMakingSafe && is_safe()) {
        leave_line(now, out);
        if (has_left_line()) return let_go_of_port(now, out);
    }
    const auto before = port_.phase();
    const bool silent = port_.tick(now, out);
    if (before == PortLoan::Phase::kMakingSafe && port_.is_away()) return let_go_of_port(now, out);
    if (!announcer_) return;
    announcer_->set_updating(port_.updating());
    if (silent) announcer_->set_state(model::BoardState::kLost, out);
}

void Bridge::let_go_of_port(Time now, Effects& out) {
    announcer_->set_state(model::BoardState::kUpdating, out);
    safety_.board_gone(out);
    session::Actions actions;
    session_.link_down(now, actions);
    perform(actions, now, out);
    port_.let_go(out);
    announcer_->set_updating(port_.updating());
}

}  // namespace asip::agent
