// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <unordered_map>

#include "agent/safety/holds.hpp"
#include "agent/safety/safe_lines.hpp"
#include "asip/session/machine.hpp"
#include "tests/truth/ledger.hpp"
#include "tests/truth/wire.hpp"

namespace truth {

/// The session under test, with what a program has to do for it: performs its actions on the line, calls it
/// in time, and gives its answers to the ledger.
class Agent {
  public:
    Agent(const Plan& plan, Dice& dice, Ledger& ledger, Wire& to_board, Ledger::Note note);
    void link_up(bool restarting, Micros now);
    void link_down(Micros now);
    /// Another session takes its place.
    void restart(Micros now);
    void receive(std::string_view bytes, Micros now);
    void submit(Command command, Micros now);
    /// The client's holds last for as long again, from now on. False: it has none.
    bool renew(unsigned client, Micros now);
    void tick(Micros now);
    Micros next() const;

    /// Something is held, or is being undone.
    bool holds() const { return holds_.size() + safe_lines_.size() > 0; }
    /// When the board was last asked what it is.
    Micros identified_at() const { return identified_at_; }
    /// When the first hold was undone because its time was over.
    Micros undone_at() const { return undone_at_; }

    unsigned baud() const { return baud_; }
    asip::session::BoardSession::State state() const { return session_->state(); }

  private:
    void new_session();
    asip::session::SessionOptions options() const;
    void perform(asip::session::Actions& actions, Micros now);
    void write(const std::string& bytes, Micros now);
    void finished(const asip::session::Finished& end, Micros now);
    void note_state();
    void check_silence(Micros now);
    void board_gone();
    void make_safe(const std::string& line);
    void make_safe(Micros now);
    static std::optional<Effect> undoing(const std::string& line);
    void follow_safe_lines(Micros now);

    const Plan& plan_;
    Dice& dice_;
    Ledger& ledger_;
    Wire& to_board_;
    Ledger::Note note_;

    std::optional<asip::session::Machine> session_;
    std::unordered_map<asip::session::RequestId, std::size_t> commands_;
    std::unordered_map<asip::session::RequestId, std::string> safe_;  // forms of commands with a hold
    asip::agent::Holds holds_;
    asip::agent::SafeLines safe_lines_;
    Micros undone_at_ = kNever;
    Micros identified_at_ = 0;
    unsigned baud_ = 0;
    unsigned wanted_baud_ = 0;
    Micros rate_set_at_ = kNever;
    std::string held_;  // written since; leaves at the new rate
    Micros last_tick_ = -1;
    unsigned ticks_at_once_ = 0;
    Micros last_byte_ = 0;
    Micros asked_ = kNever;               // the first write since the last byte
    std::optional<asip::Time> deadline_;  // of the session, as it said when it was last called
    asip::session::BoardSession::State noted_ = asip::session::BoardSession::State::kDown;
};

}  // namespace truth
