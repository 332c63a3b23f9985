// SPDX-License-Identifier: Apache-2.0
#include "asip/session/machine.hpp"

#include <algorithm>
#include <utility>

#include "asip/protocol/request.hpp"

namespace asip::session {

namespace {

constexpr Duration kBootTime = std::chrono::milliseconds(2500);
// So long after a board was found a faster rate is tried; then it stays at the one that works.
constexpr Duration kStepUpTime = std::chrono::seconds(8);

std::string two_letters(const Random& random) {
    constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz";
    const auto drawn = random();
    return {kLetters[drawn % 26], kLetters[drawn / 26 % 26]};
}

}  // namespace

Machine::Machine(SessionOptions options, const Random& random)
    : options_(options), queue_(random), token_start_(two_letters(random)) {}

// --- link

void Machine::link_up(const LinkTraits& traits, Time now, Actions& out) {
    wire_.open(traits.baud);
    there_ = was_silent_ = no_answer_reported_ = false;
    unconfirmed_.reset();
    counters_.bytes_in = 0;
    suspect_baud_ = 0;
    found_at_.reset();
    ready_baud_ = traits.baud;
    progress_at_ = last_byte_ = now;
    banner_ = false;
    reports_.clear();
    banner_services_.clear();
    rates_.forget_bad();
    leaving_.reset();
    renewals_.clear();
    if (traits.perhaps_another_board) settings_ = {};
    restore_ = known_;
    search(traits.restarting ? now + kBootTime : now, now, out);
}

void Machine::link_down(Time, Actions& out) {
    state_ = Down{};
    there_ = false;
    std::vector<RequestEnd> ended;
    queue_.abandon_in_flight(Ending::kTimeout, ended);
    queue_.abandon_waiting(ended);
    report(ended, out);
}

void Machine::line_rate_set(bool ok, Time now, Actions& out) {
    auto* const stepping = std::get_if<SteppingUp>(&state_);
    if (stepping == nullptr) return;
    std::vector<std::string> lines;
    stepping->change.on_rate_set(ok, now, lines);
    write(lines, now, out);
    follow(*stepping, now, out);
}

// --- from state to state

void Machine::search(Time quiet_until, Time now, Actions& out) {
    wire_.reader().reset();
    abandon_in_flight(Ending::kDoubt, out);
    const auto* const identifying = std::get_if<Identifying>(&state_);
    if (identifying == nullptr && !std::holds_alternative<Searching>(state_)) progress_at_ = now;
    Search search;
    search.start(wire_.start_baud(), wire_.has_rates(), identifying ? Search::longer(identifying->turn) : 1,
                 quiet_until, now, options_.opens_for_rate);
    asked_at_.reset();
    state_ = Searching{search, now, false};
    ask(std::get<Searching>(state_), now, out);
}

void Machine::identify(Time now, Actions& out) {
    wire_.forget_checksums();
    if (suspect_baud_ != 0 && suspect_baud_ == wire_.baud()) rates_.mark_bad(wire_.baud());
    suspect_baud_ = 0;
    if (wire_.at_start_rate() && std::exchange(ready_baud_, wire_.baud()) != wire_.baud()) {
        ++counters_.resets;
        out.emplace_back(BoardReset{"it is at its start rate again"});
    }
    std::vector<std::string> lines;
    Interview interview = new_interview(now, lines);
    const auto* const searching = std::get_if<Searching>(&state_);
    state_ = Identifying{std::move(interview), searching ? searching->search.turn() : 1};
    write(lines, now, out);
}

void Machine::set_up_line(Identity found, Time now, Actions& out) {
    const bool can_step = wire_.has_rates() && options_.max_baud != 0 &&
                          !(options_.opens_for_rate && banner_) &&
                          found.extensions.has(protocol::kLineRate) && found.extensions.has(protocol::kEcho);
    const bool changed = !known_ || !same_board(identity_, found);
    changed_ = changed_ || changed;
    if (known_ && changed && is_other_board(identity_, found)) settings_ = {};
    identity_ = std::move(found);
    if (!identity_.extensions.empty()) renewals_.clear();  // its reports do not end
    known_ = true;
    no_answer_reported_ = true;  // whatever becomes of the rate: it answered
    if (!found_at_) found_at_ = now;
    const bool may_stay = wire_.at_start_rate() && now >= *found_at_ + kStepUpTime;
    const unsigned best = can_step && !may_stay ? rates_.best(options_.max_baud) : wire_.baud();
    if (best == wire_.baud()) return become_ready(now, out);
    std::vector<std::string> lines;
    RateChange change(best, token_start_, now, lines);
    state_ = SteppingUp{std::move(change)};
    write(lines, now, out);
}

void Machine::become_ready(Time now, Actions& out) {
    there_ = no_answer_reported_ = true;
    was_silent_ = false;
    found_at_.reset();
    ready_baud_ = wire_.baud();
    state_ = Ready{now, 0};
    queue_.restart();
    queue_.set_byte_time(wire_.byte_time());
    queue_.set_longest_request(identity_.extensions.longest_request());
    queue_.set_checksum_bytes(wire_.writes_checksums() ? Wire::kChecksumBytes : 0);
    if (restore_) restore_settings();
    restore_ = true;
    restore_again_ = false;
    out.emplace_back(Identified{std::exchange(changed_, false)});
    pump(now, out);
}

void Machine::board_restarted(std::string why, Time now, Actions& out) {
    if (leaving_) return has_left();  // nothing is to be given back
    if (!std::holds_alternative<Identifying>(state_)) progress_at_ = now;
    ++counters_.resets;
    out.emplace_back(BoardReset{std::move(why)});
    abandon_in_flight(Ending::kDoubt, out);
    identify(now, out);
}

void Machine::fall_silent(Time now, Actions& out) {
    there_ = false;
    was_silent_ = true;
    out.emplace_back(BecameSilent{});
    std::vector<RequestEnd> ended;
    queue_.abandon_in_flight(Ending::kTimeout, ended);
    queue_.abandon_waiting(ended);
    report(ended, out);
    search(now, now, out);
}

// --- requests

bool may_be_sent(const protocol::Request& request) {
    // The line rate, checksums and the digest of requests are the session's own.
    return request.service != '#' || std::string_view("BCV").find(request.tag) == std::string_view::npos;
}

Expected<RequestId, Refusal> Machine::submit(std::string_view line, const RequestOptions& wanted, Time now,
                                             Actions& out) {
    while (!line.empty() && (line.back() == '\n' || line.back() == '\r'))
        line.remove_suffix(1);
    const auto request = protocol::parse_request(line);
    if (!request) return Unexpected<Refusal>(Refusal::kInvalid);
    return submit(*request, wanted, now, out);
}

Expected<RequestId, Refusal> Machine::submit(const protocol::Request& parsed, const RequestOptions& wanted,
                                             Time now, Actions& out) {
    if (!may_be_sent(parsed)) return Unexpected<Refusal>(Refusal::kInvalid);
    if (!accepts_requests()) return Unexpected<Refusal>(Refusal::kNoBoard);
    if (parsed.line.size() > identity_.extensions.longest_request())
        return Unexpected<Refusal>(Refusal::kTooLong);
    if (wanted.urgent ? queue_.waiting().urgent() >= BoardSession::kMaxUrgent : room(wanted.client) == 0)
        return Unexpected<Refusal>(Refusal::kQueueFull);
    if (NameBudget::concerns(parsed.line)) {
        if (names_.left(now) == 0) return Unexpected<Refusal>(Refusal::kTooManyNames);
        names_.spend(now);
    }
    Request request;
    request.id = next_id_++;
    request.client = wanted.client;
    request.line = std::string(parsed.line);
    request.deadline = wanted.deadline.value_or(now + kDefaultDeadline);
    request.prove = wanted.prove;
    request.urgent = wanted.urgent;
    request.more_follow = wanted.more_follow;
    request.answer_tag = wanted.answer_tag;
    request.answer_time = wanted.answer_time;
    request.is_answer = wanted.is_answer;
    request.alone = parsed.service != '#' && identity_.find_service(parsed.service) == nullptr;
    const RequestId id = request.id;
    if (wanted.urgent) will_execute(parsed.line);
    queue_.waiting().push(std::move(request));
    if (std::holds_alternative<Ready>(state_)) on_time(std::get<Ready>(state_), now, out);
    return id;
}

std::size_t Machine::cancel_waiting(Actions& out) {
    std::vector<RequestEnd> ended;
    queue_.cancel_waiting(ended);
    const std::size_t count = ended.size();
    report(ended, out);
    return count;
}

std::size_t Machine::room(ClientId client) const {
    const auto& waiting = queue_.waiting();
    const std::size_t all = BoardSession::kMaxQueued - std::min(waiting.size(), BoardSession::kMaxQueued);
    const std::size_t own = BoardSession::kMaxQueuedPerClient -
                            std::min(waiting.size_of(client), BoardSession::kMaxQueuedPerClient);
    return std::min(all, own);
}

void Machine::write(const std::vector<std::string>& lines, Time now, Actions& out) {
    if (lines.empty()) return;
    wire_.write(lines, out);
    counters_.bytes_out = wire_.bytes_out();
    if (!asked_at_) asked_at_ = now;
}

void Machine::abandon_in_flight(Ending ending, Actions& out) {
    std::vector<RequestEnd> ended;
    queue_.abandon_in_flight(ending, ended);
    report(ended, out);
}

void Machine::note_period(const RequestEnd& end) {
    const char service = end.request.service();
    if (end.ending == Ending::kNotSent || end.ending == Ending::kBoardError) return;
    std::erase_if(new_periods_, [&](const NewPeriod& period) { return period.service == service; });
    const bool in_doubt = end.ending == Ending::kDoubt || end.ending == Ending::kTimeout;
    new_periods_.push_back({service, in_doubt, last_byte_});
}

void Machine::report(std::vector<RequestEnd>& ended, Actions& out) {
    for (RequestEnd& end : ended) {
        if (end.ending == Ending::kExecuted || end.ending == Ending::kUnproven ||
            end.ending == Ending::kNoValue) {
            if (!end.request.restores) settings_.executed(end.request.line, keeps_level());
            if (end.request.restores && end.request.service() == 'I' && end.request.tag() == 'd')
                out.emplace_back(LevelRestored{end.request.line});
            if (end.request.line == "#,R") reports_.clear(), renewals_.clear();
            const auto mode = parse_mode_request(end.request.line);
            if (mode && static_cast<std::size_t>(mode->pin) < identity_.pin_modes.size())
                identity_.pin_modes[static_cast<std::size_t>(mode->pin)] =
                    static_cast<protocol::PinMode>(mode->mode);
        }
        const bool in_doubt = end.ending == Ending::kDoubt || end.ending == Ending::kTimeout;
        if (in_doubt && !end.request.restores) settings_.in_doubt(end.request.line);
        if (end.ending == Ending::kBoardError) settings_.refused(end.request.line);
        if (end.request.tag() == 'A') {
            note_period(end);
            note_renewed(end.request.service());
        }
        if (end.request.id == 0 && in_doubt && SettingsMemory::is_setting(end.request.line))
            restore_again_ = true;
        if (end.request.id == 0) continue;
        out.emplace_back(Finished{end.request.id, end.ending, end.not_sent, end.code, std::move(end.text),
                                  std::move(end.answer)});
    }
    ended.clear();
}

// --- time

void Machine::tick(Time now, Actions& out) {
    if (std::holds_alternative<Down>(state_)) return;
    if (leaving_ && leaving_->asked && now >= leaving_->until) return has_left();
    if (const auto gone = gone_at(); gone && now >= *gone) return fall_silent(now, out);
    if (!no_answer_reported_ && now >= progress_at_ + options_.patience) {
        no_answer_reported_ = true;
        out.emplace_back(NoAnswer{counters_.bytes_in > 0, banner_});
    }
    std::vector<RequestEnd> ended;
    queue_.on_time(now, options_.answer_timeout, ended);
    counters_.fence_timeouts = queue_.fence_timeouts();
    report(ended, out);
    std::visit([&](auto& state) { on_time(state, now, out); }, state_);
}

std::optional<Time> Machine::next_deadline() const {
    if (std::holds_alternative<Down>(state_)) return std::nullopt;
    Time deadline = queue_.next_deadline(options_.answer_timeout);
    if (leaving_) deadline = std::min(deadline, leaving_->until);
    if (const auto gone = gone_at()) deadline = std::min(deadline, *gone);
    if (!no_answer_reported_) deadline = std::min(deadline, progress_at_ + options_.patience);
    return std::min(deadline, std::visit([&](const auto& state) { return this->deadline(state); }, state_));
}

// The program did not listen: that it heard nothing says nothing.
void Machine::not_watched(Time since, Time now) {
    const auto later = [&](Time time) { return std::min(now, time + (now - since)); };
    last_byte_ = later(last_byte_);
    progress_at_ = later(progress_at_);
    if (asked_at_) asked_at_ = later(*asked_at_);
}

// A board that was never there, or is known to be gone, cannot be lost.
std::optional<Time> Machine::gone_at() const {
    if (!there_ || !asked_at_) return std::nullopt;
    Time gone = std::max(last_byte_ + options_.gone_after, *asked_at_ + options_.answer_timeout);
    return gone;
}

BoardSession::State Machine::state() const {
    using Public = BoardSession::State;
    if (std::holds_alternative<Down>(state_)) return Public::kDown;
    if (std::holds_alternative<Ready>(state_)) return Public::kReady;
    if (std::holds_alternative<Searching>(state_)) return was_silent_ ? Public::kSilent : Public::kSearching;
    return Public::kIdentifying;
}

bool Machine::has_checksums() const {
    return identity_.extensions.has(protocol::kChecksum) && identity_.extensions.has(protocol::kEcho);
}

bool Machine::wants_checksums() const {
    if (!has_checksums() || options_.checksum == ChecksumPolicy::kNever) return false;
    return options_.checksum == ChecksumPolicy::kAlways || damage_seen_ || wire_.is_fast();
}

}  // namespace asip::session
