// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "tests/truth/agent.hpp"
#include "tests/truth/board_model.hpp"
#include "tests/truth/ledger.hpp"
#include "tests/truth/plan.hpp"
#include "tests/truth/wire.hpp"

namespace truth {

/// The session and the firmware with the line between them, in simulated time, and the ledger that follows
/// both.
class World {
  public:
    World(const World&) = delete;
    World& operator=(const World&) = delete;

  protected:
    struct Setting {
        Dice dice;
        Plan plan;
        bool calm;   ///< nothing disturbs it
        bool trace;  ///< keep lines of what happens
    };
    explicit World(Setting setting);
    virtual ~World() = default;

    void note(const std::string& text);
    /// When something happens next, `other` at the latest; not before now.
    Micros next(Micros other) const;
    /// What is due now: incidents, the board, bytes to the host, the session.
    void pass();
    bool is_link_up() const { return link_back_at_ == kNever; }

    virtual void on_fault(const WireByte&) {}
    virtual void on_read(const BoardRead&) {}
    virtual void on_board_off() {}
    virtual void on_incident(const Incident&) {}

    Dice dice_;
    Plan plan_;
    bool trace_;
    Micros now_ = 0;
    std::vector<std::string> lines_;
    Ledger::Note note_;
    Ledger ledger_;
    Wire to_board_, to_host_;
    BoardModel board_;
    Agent agent_;
    std::vector<Incident> incidents_;  ///< in the order of their times
    std::size_t next_incident_ = 0;

  private:
    Wire::OnFault fault_of_line(bool to_board);
    BoardModel::Reports reports();
    void deliver();
    void happen(const Incident& incident);
    void link_back();

    Micros link_back_at_ = kNever;
};

}  // namespace truth
