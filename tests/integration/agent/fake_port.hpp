// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/unit/session/scripted_board.hpp"

namespace asip::test {

/// A pseudo-terminal with a scripted board behind it, for what real firmware never says. Has a thread of its
/// own.
class FakePort {
  public:
    explicit FakePort(bool answers = true);
    ~FakePort();
    FakePort(const FakePort&) = delete;
    FakePort& operator=(const FakePort&) = delete;

    const std::string& path() const { return path_; }
    /// Bytes from the board, as they are.
    void say(std::string_view bytes);
    /// From now on the board says `line` without a pause; empty: stops.
    void flood(std::string line);
    bool executed(const std::string& line);
    /// Every whole line that the board heard.
    std::vector<std::string> heard();

  private:
    void serve();

    int master_ = -1;
    int slave_ = -1;  // kept open, so that the master never sees the agent's end as a hang-up
    std::string path_;
    bool answers_;
    std::mutex mutex_;
    session::ScriptedBoard board_;
    std::string flood_;
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace asip::test
