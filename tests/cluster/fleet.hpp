// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/cluster/board.hpp"
#include "tests/cluster/commander.hpp"
#include "tests/cluster/echo.hpp"
#include "tests/cluster/engine.hpp"
#include "tests/cluster/faults.hpp"
#include "tests/cluster/network.hpp"
#include "tests/cluster/process.hpp"
#include "tests/cluster/watcher.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/truth/presence/machine.hpp"

namespace cluster {

struct FleetOptions {
    std::size_t boards = 12;
    std::size_t firmware = 1;  ///< so many of the boards are real firmware in a simulator
    std::size_t registries = 3;
    std::size_t clients = 3;
    double per_board = 2;            ///< commands a second
    bool processes = true;           ///< faults of processes and links, too
    bool clock = false;              ///< faults of clocks, too
    Millis longest_stop = 20'000;    ///< of faults at random
    std::string only{};              ///< fault at random, by name; empty: all
    std::string log_level = "info";  ///< of agents and registries
    Millis steady = 1500;            ///< for so long the catalogues must stay right
};

/// Registries, agents with scripted boards, clients and watchers around an engine, each with another node
/// first in its list. Two further boards leave when all is set up, one with a goodbye and one without. What
/// happens is written into the history.
class Fleet {
  public:
    /// With a network each registry, and each third of the agents, is on a host of its own.
    Fleet(boost::asio::io_context& io, Engine& engine, Network* network, const FleetOptions& options,
          const truth::Machine& machine, History& history);

    static constexpr std::size_t kShares = 3;
    /// How many hosts it needs.
    static std::size_t hosts(const FleetOptions& options);

    /// Waits until everything is there and every board can be commanded. Throws std::runtime_error when it
    /// does not come to that.
    void set_up();
    /// One round: does these faults, puts everything back, and looks until all is well again.
    void suffer(const std::vector<Fault>& faults);
    /// Waits for the last answers.
    void finish();

    Shape shape() const;
    /// The log of each program into a file of the folder.
    void write_logs(const std::string& folder) const;

  private:
    static constexpr Millis kTurn = 20;  // between two looks

    std::unique_ptr<Board> make_board(std::size_t index);
    std::vector<std::string> program(const std::string& name, std::size_t first_node,
                                     std::vector<std::string> more) const;
    /// Where everything connects to.
    asip::mqtt::Options connection(const std::string& id, std::size_t first_node) const;
    /// As connection(), for one that stays with its node.
    asip::mqtt::Options echo(std::size_t node) const;
    std::unique_ptr<Process> start(std::size_t host, bool own_clock, std::vector<std::string> command) const;
    void step_clock(std::chrono::seconds ahead) const;
    std::size_t host_of_registry(std::size_t registry) const;
    std::size_t host_of_share(std::size_t share) const;
    void weather(const Fault& fault, bool begins);
    std::vector<std::size_t> hosts_of(const Fault& fault) const;
    void depart();
    void run_until(Millis time);
    void begin(const Fault& fault);
    void end(const Fault& fault);
    Process& process(const Fault& fault);
    void nodes(const Fault& fault, void (Engine::*what)(std::size_t));
    void look_for_ends();
    /// False: the programs had had the time for it long ago.
    bool wait_for(const std::function<bool()>& done);
    /// Until the programs had the time for it behind the engine.
    void look_for_recovery(Round& round);
    bool recovered(Round& round);
    bool had_time(const Round& round) const;
    std::optional<Millis> commands_work(Millis end, std::vector<std::size_t>& mute) const;
    std::optional<Millis> engine_works(Millis end) const;
    std::optional<Millis> catalogues_agree(Millis end) const;

    boost::asio::io_context& io_;
    Engine& engine_;
    Hosts hosts_;
    Network* network_;
    FleetOptions options_;
    const truth::Machine& machine_;
    asip::test::TempDir folder_;
    History& history_;
    Truth truth_;
    std::vector<std::unique_ptr<Board>> boards_;  // the last two are those that leave
    std::vector<std::unique_ptr<Process>> agents_;
    std::vector<std::unique_ptr<Process>> registries_;
    std::vector<std::unique_ptr<Watcher>> watchers_;
    std::vector<std::unique_ptr<Commander>> commanders_;
    std::vector<std::unique_ptr<Echo>> echoes_;
};

}  // namespace cluster
