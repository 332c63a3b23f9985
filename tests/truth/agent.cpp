// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/agent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "asip/protocol/body.hpp"

namespace truth {

namespace session = asip::session;

namespace {

constexpr unsigned kStartBaud = 57'600;
constexpr unsigned kSafetyClient = 99;

// A board that was asked something and is silent for so long is gone; a last question may still wait for its
// answer then.
constexpr Micros kSilence = 4 * kSecond;
constexpr Micros kLastAnswer = 1500 * kMillisecond;

asip::Time at(Micros now) {
    return asip::Time{} + std::chrono::hours(1) + std::chrono::microseconds(now);
}

Outcome outcome(session::Ending ending) {
    switch (ending) {
        case session::Ending::kExecuted:
            return Outcome::kExecuted;
        case session::Ending::kUnproven:
            return Outcome::kUnproven;
        case session::Ending::kBoardError:
            return Outcome::kBoardError;
        case session::Ending::kDoubt:
            return Outcome::kDoubt;
        case session::Ending::kNoValue:
            return Outcome::kNoValue;
        case session::Ending::kTimeout:
            return Outcome::kTimeout;
        case session::Ending::kNotSent:
            return Outcome::kNotSent;
    }
    return Outcome::kTimeout;
}

}  // namespace

Agent::Agent(const Plan& plan, Dice& dice, Ledger& ledger, Wire& to_board, Ledger::Note note)
    : plan_(plan), dice_(dice), ledger_(ledger), to_board_(to_board), note_(std::move(note)) {
    baud_ = kStartBaud;
    new_session();
}

void Agent::new_session() {
    session_.emplace(options(), [this] { return dice_.draw(); });
    deadline_.reset();
}

session::SessionOptions Agent::options() const {
    session::SessionOptions options;
    options.max_baud = plan_.max_baud;
    using Policy = session::ChecksumPolicy;
    options.checksum = plan_.checksum == Plan::Checksum::kAlways  ? Policy::kAlways
                       : plan_.checksum == Plan::Checksum::kNever ? Policy::kNever
                                                                  : Policy::kAuto;
    return options;
}

void Agent::link_up(bool restarting, Micros now) {
    note_(fmt::format("link up{}", restarting ? ", the board restarts" : ""));
    session::Actions actions;
    baud_ = kStartBaud;
    rate_set_at_ = asked_ = kNever;
    held_.clear();
    last_byte_ = now;
    session_->link_up({plan_.tcp ? 0 : baud_, restarting}, at(now), actions);
    perform(actions, now);
}

void Agent::link_down(Micros now) {
    note_("link down");
    session::Actions actions;
    session_->link_down(at(now), actions);
    board_gone();
    rate_set_at_ = kNever;
    held_.clear();
    ledger_.delivery_cut();
    perform(actions, now);
}

void Agent::restart(Micros now) {
    ledger_.session_ended(now);
    commands_.clear();
    new_session();
    ledger_.delivery_cut();
    link_up(false, now);
}

// Line by line, so that the ledger knows what the session knew at each of its decisions.
void Agent::receive(std::string_view bytes, Micros now) {
    last_byte_ = now;
    asked_ = kNever;
    while (!bytes.empty()) {
        const auto end = std::min(bytes.find('\n'), bytes.size() - 1) + 1;
        ledger_.delivered(bytes.substr(0, end), now);
        session::Actions actions;
        session_->receive(bytes.substr(0, end), at(now), actions);
        perform(actions, now);
        bytes.remove_prefix(end);
    }
}

bool Agent::renew(unsigned client, Micros now) {
    const auto renewed = holds_.renew(client, "io", std::nullopt, std::nullopt, at(now));
    note_(fmt::format("client {} renews {} holds", client, renewed));
    return renewed > 0;
}

// As agent/safety/Safety does.
void Agent::board_gone() {
    for (const auto& hold : holds_.take_all())
        make_safe(hold.safe);
}

void Agent::make_safe(const std::string& line) {
    safe_lines_.add(line);
    session_->will_execute(line);
}

void Agent::make_safe(Micros now) {
    for (const auto& hold : holds_.take_expired(at(now))) {
        undone_at_ = std::min(undone_at_, now);
        make_safe(hold.safe);
    }
    follow_safe_lines(now);
}

// The ledger knows these lines as commands.
void Agent::follow_safe_lines(Micros now) {
    struct Submitting {
        Agent& agent;
        Micros now;
        bool accepts_requests() const { return agent.session_->accepts_requests(); }
        asip::Expected<session::RequestId, session::Refusal> submit(const std::string& line,
                                                                    const session::RequestOptions& options,
                                                                    asip::Time, session::Actions& actions) {
            Command command;
            command.client = kSafetyClient;
            command.line = line;
            command.effect = agent.undoing(line);
            command.lasts = kSecond;
            command.urgent = true;
            const auto index = agent.ledger_.submitted(std::move(command), now);
            const auto id = agent.session_->submit(line, options, at(now), actions);
            agent.note_(fmt::format("undone: #{} `{}`", index, line));
            if (id)
                agent.commands_[*id] = index;
            else
                agent.ledger_.refused(index, now);
            return id;
        }
    } submitting{*this, now};
    if (safe_lines_.size() == 0) return;
    session::Actions actions;
    safe_lines_.send(submitting, at(now), actions);
    perform(actions, now);
}

std::optional<Effect> Agent::undoing(const std::string& line) {
    const auto comma = line.rfind(',');
    if (!line.starts_with("I,d,")) return std::nullopt;
    return Effect{Effect::Kind::kLevel, static_cast<unsigned>(std::stoul(line.substr(4, comma - 4))),
                  std::stoi(line.substr(comma + 1))};
}

void Agent::submit(Command command, Micros now) {
    session::RequestOptions wanted;
    wanted.client = command.client;
    wanted.deadline = at(now + command.lasts);
    wanted.prove = command.prove;
    wanted.answer_tag = command.answer_tag;
    // The range finder is the only service here whose values are asked for.
    if (command.line == "D,M")
        wanted.is_answer = [](const auto& event) {
            return asip::protocol::parse_body(event.body).has_value();
        };
    session::Actions actions;
    const std::size_t index = ledger_.submitted(command, now);
    const auto id = session_->submit(command.line, wanted, at(now), actions);
    note_(fmt::format("client {} #{} `{}`{}{}", command.client, index, command.line,
                      command.prove ? "" : " (no proof)",
                      id ? "" : std::string(", refused: ") + session::to_string(id.error())));
    if (id && command.hold > 0) {
        safe_[*id] = command.safe;
        holds_.begin({command.client,
                      {},
                      "io",
                      command.line,
                      command.safe,
                      std::chrono::microseconds(command.hold),
                      at(now + command.hold),
                      *id});
    }
    if (id)
        commands_[*id] = index;
    else
        ledger_.refused(index, now);
    perform(actions, now);
}

void Agent::check_silence(Micros now) {
    if (asked_ == kNever || !session_->accepts_requests()) return;
    if (now > std::max(last_byte_ + kSilence, asked_ + kLastAnswer) + kLastAnswer)
        ledger_.fail("the board is silent, and the session still accepts commands");
}

void Agent::tick(Micros now) {
    check_silence(now);
    make_safe(now);
    if (rate_set_at_ <= now) {
        rate_set_at_ = kNever;
        const bool fails = dice_.chance(plan_.rate_fails);
        if (!fails) baud_ = wanted_baud_;
        if (!fails) ledger_.delivery_cut();
        note_(fmt::format("rate {} {}", wanted_baud_, fails ? "could not be set" : "set"));
        if (const auto held = std::exchange(held_, {}); !held.empty()) write(held, now);
        session::Actions actions;
        session_->line_rate_set(!fails, at(now), actions);
        perform(actions, now);
    }
    if (!deadline_ || *deadline_ > at(now)) return;
    ticks_at_once_ = now == last_tick_ ? ticks_at_once_ + 1 : 0;
    last_tick_ = now;
    if (ticks_at_once_ > 100) return ledger_.fail("the session wants to be called again and again");
    session::Actions actions;
    session_->tick(at(now), actions);
    perform(actions, now);
}

Micros Agent::next() const {
    Micros next = rate_set_at_;
    if (const auto ends = holds_.next_deadline())
        next = std::chrono::ceil<std::chrono::microseconds>(*ends - at(0)).count();
    next = std::min(next, rate_set_at_);
    if (deadline_) {
        const auto since = std::chrono::ceil<std::chrono::microseconds>(*deadline_ - at(0)).count();
        next = std::min(next, std::max<Micros>(since, last_tick_));
    }
    return next;
}

void Agent::perform(session::Actions& actions, Micros now) {
    for (const auto& action : actions) {
        if (std::holds_alternative<session::Identified>(action)) identified_at_ = now;
        if (const auto* bytes = std::get_if<session::Write>(&action)) {
            write(bytes->bytes, now);
        } else if (const auto* rate = std::get_if<session::SetLineRate>(&action)) {
            wanted_baud_ = rate->baud;
            rate_set_at_ = std::max(now, to_board_.free_at()) + 200;
        } else if (const auto* end = std::get_if<session::Finished>(&action)) {
            finished(*end, now);
        } else if (const auto* garbage = std::get_if<session::Garbage>(&action)) {
            note_(fmt::format("session: garbage, {}: `{}`", garbage->reason, garbage->sample));
        } else if (const auto* reset = std::get_if<session::BoardReset>(&action)) {
            note_("session: board reset: " + reset->why);
            for (const auto& hold : holds_.take_all())
                session_->will_execute(hold.safe);
        } else if (std::holds_alternative<session::BecameSilent>(action)) {
            board_gone();
        } else if (const auto* changed = std::get_if<session::LineRateChanged>(&action)) {
            note_(fmt::format("session: rate {}: {}", changed->baud, changed->why));
        }
    }
    deadline_ = session_->next_deadline();
    note_state();
}

void Agent::note_state() {
    if (session_->state() == noted_) return;
    noted_ = session_->state();
    note_(std::string("session: ") + session::to_string(noted_));
}

void Agent::write(const std::string& bytes, Micros now) {
    asked_ = std::min(asked_, now);
    // As the link does (KeptStream).
    if (rate_set_at_ != kNever) {
        held_ += bytes;
        return;
    }
    std::size_t begin = 0;
    while (begin < bytes.size()) {
        std::size_t end = bytes.find('\n', begin);
        if (end == std::string::npos) return ledger_.fail("the session wrote half a line");
        const std::string line = bytes.substr(begin, end - begin);
        note_("> " + line);
        const auto number = ledger_.wrote(line, now);
        for (const char c : bytes.substr(begin, end + 1 - begin))
            to_board_.send(c, number, baud_, now);
        begin = end + 1;
    }
}

void Agent::finished(const session::Finished& end, Micros now) {
    const auto known = commands_.find(end.id);
    if (known == commands_.end()) return ledger_.fail("a request ended that is not open");
    note_(fmt::format("#{} {} {} {} {}", known->second, to_string(outcome(end.ending)), end.code, end.text,
                      end.answer.text()));
    if (const auto safe = safe_.find(end.id); safe != safe_.end()) holds_.on_finished(end, safe->second);
    std::vector<asip::agent::SafeLines::Done> done;
    safe_lines_.on_finished(end, done);
    ledger_.answered(known->second, {outcome(end.ending), end.code, end.answer.text()}, now);
    commands_.erase(known);
}

}  // namespace truth
