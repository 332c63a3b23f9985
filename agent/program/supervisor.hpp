// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "agent/cable/cables.hpp"
#include "agent/program/board_agent.hpp"
#include "agent/program/plan.hpp"
#include "asip/program/stop_signal.hpp"

namespace asip::agent {

/// Runs an agent for each board of the plan, in one event loop. With one board of a command line, the program
/// ends with it. Boards of a file are started again when they end, later each time (2 s to 1 min), and SIGHUP
/// reads the file anew.
class Supervisor {
  public:
    /// `read_again`: the plan of the same file now.
    Supervisor(Plan plan, std::function<Expected<Plan>()> read_again);
    ~Supervisor();

    /// Until a signal comes, or the only board ends. Returns the exit status. Call it once.
    int run();

  private:
    /// It runs now, or waits to be started again.
    struct Board;
    // Boards
    void start_all();
    void start(Board& board, Duration after);
    void serve(Board& board);
    void ended(Board& board, int status);
    void start_again(Board& board, int status);
    void remove(Board& board);
    // Boards that browsers lend (supervisor_cables.cpp)
    void serve_cables(Lending lending);
    void plugged(const std::string& place, const std::string& port, std::shared_ptr<const Lent> lent,
                 AgentOptions options);
    void left(const std::string& place);
    unsigned free_number() const;
    void tell_lender(const Board& board);
    std::shared_ptr<Board> find(const std::string& key) const;
    // Signals: the end, and a changed file
    void stop();
    void wait_for_reload();
    void reload();
    void nothing_to_reload();
    void apply(Plan plan);
    // What systemd shows of it, at most twice a second
    void report_soon();
    std::string status_text() const;

    boost::asio::io_context io_{1};
    boost::asio::thread_pool disk_{1};
    StopLines stops_{io_};
    std::set<BoardAgent*> agents_;
    const bool several_;
    const std::function<Expected<Plan>()> read_again_;
    const bool has_terminal_;
    Random random_;
    std::vector<std::shared_ptr<Board>> boards_;
    std::unique_ptr<Cables> cables_;  // none: no browser lends a board here
    program::StopSignal stop_signal_;
    boost::asio::signal_set reload_signal_;
    boost::asio::steady_timer report_timer_;
    bool report_waits_ = false;
    bool stopping_ = false;
    int status_ = 0;
};

}  // namespace asip::agent
