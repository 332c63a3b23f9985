// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>

#include "asip/session/board_session.hpp"
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
    void tick(Micros now);
    Micros next() const;

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

    const Plan& plan_;
    Dice& dice_;
    Ledger& ledger_;
    Wire& to_board_;
    Ledger::Note note_;
    std::optional<asip::session::BoardSession> session_;
    std::unordered_map<asip::session::RequestId, std::size_t> commands_;
    unsigned baud_;
    unsigned wanted_baud_ = 0;
    Micros rate_set_at_ = kNever;
    std::string held_;  // written since; leaves at the new rate
    Micros last_tick_ = -1;
    unsigned ticks_at_once_ = 0;
    Micros last_byte_ = 0;
    Micros asked_ = kNever;  // the first write since the last byte
    asip::session::BoardSession::State noted_ = asip::session::BoardSession::State::kDown;
};

}  // namespace truth
