// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>

#include "asip/program/stop_signal.hpp"
#include "bench/load/commander.hpp"
#include "bench/load/fleet.hpp"
#include "bench/load/options.hpp"
#include "bench/load/queries.hpp"
#include "bench/load/report.hpp"
#include "bench/load/watch.hpp"
#include "bench/load/watchers.hpp"

namespace asip::load {

/// The program: owns the boards, the script, the observers and the report, and runs them on one event loop.
///
/// The steps of a run: boards are commanded, queried and watched while the script runs; then the program
/// waits for answers that are under way; then it compares the registries with the truth; then all boards say
/// goodbye.
class Application {
  public:
    /// Opens no connection yet.
    explicit Application(LoadOptions options);

    /// Runs until the time is over, or a signal comes. Prints the report on standard output. Returns the exit
    /// status: kExitOk where Report::good(), kExitBroker where no connection was made, kExitNameConflict
    /// where names are held by others, else kExitFailure. Call it once.
    int run();

  private:
    void schedule_steps();
    void schedule_progress();
    void stop();
    void await_answers(Time until);
    void compare();
    void compared();
    void hopeless(const std::string& why);
    void finish();
    int print();

    // What observes the boards is there only where an option asks for it.
    LoadOptions options_;
    boost::asio::io_context io_{1};
    Fleet fleet_;
    Plan plan_;
    std::optional<Watch> watch_;
    std::optional<Commander> commander_;
    std::optional<Queries> queries_;
    std::optional<Watchers> watchers_;
    program::StopSignal stop_signal_;
    boost::asio::steady_timer steps_timer_;
    boost::asio::steady_timer progress_timer_;
    boost::asio::steady_timer answers_timer_;
    Time started_{};
    Report report_;
    bool stopping_ = false;
    bool no_broker_ = false;
};

}  // namespace asip::load
