// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "tests/truth/dice.hpp"

namespace truth {

/// A serial line with damage: a pseudo-terminal for the agent, at a path that stays the same, whose bytes go
/// to and from a TCP port of the simulator. It has a thread of its own.
class LineProxy {
  public:
    LineProxy(std::string path, std::uint16_t board_port, std::uint64_t seed);
    ~LineProxy();
    LineProxy(const LineProxy&) = delete;
    LineProxy& operator=(const LineProxy&) = delete;

    /// From now on, per byte and in both directions; 0: a good line.
    void damage(double per_byte) { per_byte_ = per_byte; }
    /// Nothing passes until `resume`.
    void stall(bool on) { stalled_ = on; }
    /// The port disappears, and a new one comes at the same path.
    void unplug();
    void plug();

    /// How often such a request came from the agent, and when last; what the line did to it does not matter.
    struct Seen {
        int times = 0;
        std::int64_t last_ms = 0;
    };
    Seen seen(const std::string& request);

    std::uint64_t faults();
    /// Whether something was damaged between these times of now_ms().
    bool damaged(std::int64_t from, std::int64_t until);

  private:
    void run();
    void open_terminal();
    void connect_board();
    void pass(int from, int to, std::size_t direction);
    void note_requests(const char* bytes, std::size_t count);
    std::string spoil(const char* bytes, std::size_t count);

    std::string path_;
    std::uint16_t board_port_;
    Dice dice_;
    std::mutex mutex_;  // over the descriptors and what was seen
    int terminal_ = -1;
    int board_ = -1;
    std::array<std::string, 2> held_;
    std::string partial_;  // of a request
    std::unordered_map<std::string, Seen> seen_;
    std::atomic<double> per_byte_ = 0;
    std::atomic<bool> stalled_ = false;
    std::atomic<bool> stop_ = false;
    std::vector<std::int64_t> faults_;  // when
    std::thread thread_;
};

std::int64_t now_ms();

}  // namespace truth
