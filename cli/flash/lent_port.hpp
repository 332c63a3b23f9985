// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>

#include "asip/bus/request/agent_requests.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/environment.hpp"

namespace asip::cli {

/// A board's port while its agent has let go of it.
struct ReleasedPort {
    std::string kind;   ///< "serial" or "tcp"
    std::string path;   ///< `/dev/serial/by-id/...`
    std::string host;   ///< the machine it is at
    std::string until;  ///< when the agent takes it back
    std::string chip;
    std::string sketch;
};

/// What the agent found when it had the port again.
struct TakenPort {
    bool same = false;  ///< it may be the board that was there before
    std::string sketch_before;
    std::string sketch;
    std::string chip;
};

/// A board whose agent may be there: also one that is `lost`, as after firmware was loaded halfway. Fails
/// where the board is unknown, or its agent has ended.
Outcome<KnownBoard> find_board_with_agent(BoardSource& source, const std::string& name);

/// Asks one board's agent for its port, and gives it back.
class LentPort {
  public:
    LentPort(const Environment& environment, BusSession& session, std::string board);

    /// Fails with kExitFailure (another program has it) or kExitNoAnswer. Again: prolongs it.
    Outcome<ReleasedPort> release(std::chrono::seconds time);
    /// Prolongs it without waiting for the answer.
    void prolong(std::chrono::seconds time);
    /// Gives it back, and waits until the board answers there: up to 20 s. Fails with kExitNoAnswer where it
    /// does not.
    Outcome<TakenPort> give_back();
    /// The same without waiting.
    void give_back_unseen();

  private:
    Outcome<std::string> ask(const bus::PortRequest& request, std::chrono::milliseconds patience);

    const Environment& environment_;
    BusSession& session_;
    std::string board_;
    std::string by_;
};

}  // namespace asip::cli
