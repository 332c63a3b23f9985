// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/program/worker.hpp"

namespace asip::sim {

/// Runs all boards of an asip-sim and carries out commands.
class RunningBoards {
  public:
    /// Lines of text (maybe none), or why it was not done.
    using Reply = std::function<void(Expected<std::string>)>;

    /// `threads` workers (at most one a board) share the boards.
    RunningBoards(std::vector<std::unique_ptr<LiveBoard>> boards, unsigned threads,
                  std::chrono::nanoseconds slice);

    /// Replies once, maybe from another thread.
    void execute(std::string_view line, Reply reply);

    /// One a line, with those of parts.
    static std::string help();

  private:
    /// The boards belong to the workers' threads.
    struct Place {
        std::string board;
        std::vector<std::string> parts;
        std::size_t worker;
        std::size_t index;
    };

    void list_from(std::size_t place, std::string so_far, Reply reply);
    void send(const Place& place, std::string verb, std::string part, std::string argument, Reply reply);
    Expected<const Place*> board_called(std::string_view name) const;
    Expected<std::pair<const Place*, std::string>> part_called(std::string_view name) const;

    std::vector<Place> places_;
    std::vector<std::unique_ptr<Worker>> workers_;
};

}  // namespace asip::sim
