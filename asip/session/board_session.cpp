// SPDX-License-Identifier: Apache-2.0
#include "asip/session/board_session.hpp"

#include "asip/session/machine.hpp"

namespace asip::session {

const char* to_string(Refusal refusal) {
    switch (refusal) {
        case Refusal::kInvalid:
        case Refusal::kTooLong:
            return "invalid";
        case Refusal::kQueueFull:
        case Refusal::kTooManyNames:
            return "queue-full";
        case Refusal::kNoBoard:
            return "board-not-there";
    }
    return "?";
}

BoardSession::BoardSession(SessionOptions options, const Random& random)
    : machine_(std::make_unique<Machine>(options, random)) {}
BoardSession::~BoardSession() = default;
BoardSession::BoardSession(BoardSession&&) noexcept = default;
BoardSession& BoardSession::operator=(BoardSession&&) noexcept = default;

void BoardSession::link_up(const LinkTraits& traits, Time now, Actions& out) {
    machine_->link_up(traits, now, out);
}
void BoardSession::link_down(Time now, Actions& out) {
    machine_->link_down(now, out);
}
void BoardSession::receive(std::string_view bytes, Time now, Actions& out) {
    machine_->receive(bytes, now, out);
}
void BoardSession::leave(Leave how, Time now, Actions& out) {
    machine_->leave(how, now, out);
}
void BoardSession::tick(Time now, Actions& out) {
    machine_->tick(now, out);
}
std::size_t BoardSession::waiting(ClientId client) const {
    return machine_->requests().waiting().size_of(client);
}

void BoardSession::not_watched(Time since, Time now) {
    machine_->not_watched(since, now);
}

void BoardSession::line_rate_set(bool ok, Time now, Actions& out) {
    machine_->line_rate_set(ok, now, out);
}
Expected<RequestId, Refusal> BoardSession::submit(std::string_view line, const RequestOptions& options,
                                                  Time now, Actions& out) {
    return machine_->submit(line, options, now, out);
}

Expected<RequestId, Refusal> BoardSession::submit(const protocol::Request& request,
                                                  const RequestOptions& options, Time now, Actions& out) {
    return machine_->submit(request, options, now, out);
}
std::size_t BoardSession::cancel_waiting(Actions& out) {
    return machine_->cancel_waiting(out);
}
void BoardSession::hold_outputs(bool hold) {
    machine_->hold_outputs(hold);
}
void BoardSession::will_execute(std::string_view line) {
    machine_->will_execute(line);
}
std::vector<std::string> BoardSession::levels() const {
    return machine_->settings().levels();
}
std::optional<Time> BoardSession::next_deadline() const {
    return machine_->next_deadline();
}
unsigned BoardSession::names_left(Time now) const {
    return machine_->names_left(now);
}

std::size_t BoardSession::room(ClientId client) const {
    return machine_->room(client);
}
bool BoardSession::accepts_requests() const {
    return machine_->accepts_requests();
}
BoardSession::State BoardSession::state() const {
    return machine_->state();
}
const Identity& BoardSession::identity() const {
    return machine_->identity();
}
unsigned BoardSession::baud() const {
    return machine_->wire().baud();
}
std::size_t BoardSession::bytes_in_flight() const {
    return machine_->requests().bytes_in_flight();
}
std::size_t BoardSession::queued() const {
    return machine_->requests().waiting().size();
}
bool BoardSession::checksums() const {
    return machine_->wire().writes_checksums();
}
const SessionCounters& BoardSession::counters() const {
    return machine_->counters();
}
std::optional<unsigned> BoardSession::period(char service) const {
    return machine_->settings().period(service);
}

const char* to_string(BoardSession::State state) {
    switch (state) {
        case BoardSession::State::kDown:
            return "down";
        case BoardSession::State::kSearching:
            return "searching";
        case BoardSession::State::kIdentifying:
            return "identifying";
        case BoardSession::State::kReady:
            return "ready";
        case BoardSession::State::kSilent:
            return "silent";
    }
    return "?";
}

}  // namespace asip::session
