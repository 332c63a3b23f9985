#include "asip/session/board_session.hpp"

#include "asip/session/board_session_impl.hpp"

namespace asip::session {

BoardSession::BoardSession(SessionOptions options) : impl_(std::make_unique<Impl>(options)) {}
BoardSession::~BoardSession() = default;
BoardSession::BoardSession(BoardSession&&) noexcept = default;
BoardSession& BoardSession::operator=(BoardSession&&) noexcept = default;

void BoardSession::link_up(const LinkTraits& traits, Time now, Actions& out) {
    impl_->link_up(traits, now, out);
}
void BoardSession::link_down(Time, Actions& out) {
    impl_->link_down(out);
}
void BoardSession::receive(std::string_view bytes, Time now, Actions& out) {
    impl_->receive(bytes, now, out);
}
void BoardSession::tick(Time now, Actions& out) {
    impl_->tick(now, out);
}
void BoardSession::line_rate_set(bool ok, Time now, Actions& out) {
    impl_->line_rate_set(ok, now, out);
}
Expected<RequestId, Refusal> BoardSession::submit(std::string_view line, const RequestOptions& request,
                                                  Time now, Actions& out) {
    return impl_->submit(line, request, now, out);
}
std::optional<Time> BoardSession::next_deadline() const {
    return impl_->next_deadline();
}
BoardSession::State BoardSession::state() const {
    return impl_->state_;
}
const Identity& BoardSession::identity() const {
    return impl_->identity_;
}
unsigned BoardSession::baud() const {
    return impl_->baud_;
}
std::size_t BoardSession::bytes_in_flight() const {
    return impl_->queue_.bytes_in_flight();
}
std::size_t BoardSession::queued() const {
    return impl_->queue_.waiting();
}
const SessionCounters& BoardSession::counters() const {
    return impl_->counters_;
}
std::optional<unsigned> BoardSession::period(char service) const {
    return impl_->settings_.period(service);
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

const char* to_string(Refusal refusal) {
    switch (refusal) {
        case Refusal::kInvalid:
            return "invalid";
        case Refusal::kQueueFull:
            return "queue-full";
        case Refusal::kNoBoard:
            return "board-not-there";
    }
    return "?";
}

const char* to_string(Ending ending) {
    switch (ending) {
        case Ending::kExecuted:
            return "executed";
        case Ending::kUnproven:
            return "unproven";
        case Ending::kBoardError:
            return "error";
        case Ending::kTimeout:
            return "timeout";
        case Ending::kNotSent:
            return "not sent";
    }
    return "?";
}

}  // namespace asip::session
