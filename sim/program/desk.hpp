#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/program/worker.hpp"

namespace asip::sim {

/// All boards of one asip-sim, and the commands that work them.
class Desk {
  public:
    /// What a command answers: lines of text (none if there is nothing to tell), or the reason why it was not
    /// done.
    using Reply = std::function<void(Expected<std::string>)>;

    /// `threads` workers share the boards.
    Desk(std::vector<std::unique_ptr<LiveBoard>> boards, const std::vector<BoardConfig>& configs,
         unsigned threads, std::chrono::nanoseconds slice);

    /// Does one command line. The reply may come from another thread, and exactly once.
    void execute(std::string_view line, Reply reply);

    static std::string_view help();

  private:
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
