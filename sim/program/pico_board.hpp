// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "sim/program/live_board.hpp"

namespace asip::sim {

/// The program in which a simulated Pico runs: Node.js with sim/pico/main.mjs. It has the board's line as a
/// socket, and takes and gives lines of JSON.
class PicoProcess {
  public:
    PicoProcess() = default;
    PicoProcess(PicoProcess&& other) noexcept { *this = std::move(other); }
    PicoProcess& operator=(PicoProcess&& other) noexcept;
    ~PicoProcess();

    /// Waits until the board runs; otherwise what the program said.
    static Expected<PicoProcess> start(const nlohmann::json& board);

    int line() const { return line_; }
    int output() const { return output_; }
    bool is_running() const { return output_ >= 0; }
    void write(const nlohmann::json& command);
    /// The next line that came; nothing within `limit`, or once the program has ended (is_running()).
    std::optional<nlohmann::json> read(std::chrono::milliseconds limit);

    /// The first line of what it wrote to its standard error.
    std::string errors();

  private:
    void end();

    pid_t pid_ = -1;
    int line_ = -1, input_ = -1, output_ = -1, error_ = -1;
    std::string received_;
};

/// A Raspberry Pi Pico in the emulator rp2040js, which runs in a process of its own, by the same clock.
class PicoBoard : public LiveBoard {
  public:
    static Expected<std::unique_ptr<LiveBoard>> create(BoardFile file, Reporter& reporter);

    std::vector<std::string> part_names() const override;
    Pace tick(Time now) override;
    void add_waits(std::vector<pollfd>& waits) const override;
    Expected<std::string> command(std::string_view verb, std::string_view part, std::string_view argument,
                                  Time now) override;

  private:
    PicoBoard(BoardFile file, Reporter& reporter, PicoProcess process);
    SimTime board_time() const override { return time_; }
    Expected<std::string> ask(std::string_view verb, std::string_view part, std::string_view argument);
    Expected<std::string> plug(bool in);
    void heard(const nlohmann::json& event);
    void hear_all();
    void carry_to_board();
    void carry_from_board();
    bool has_room() const;

    PicoProcess process_;
    std::vector<std::string> parts_;
    std::string to_board_;
    SimTime time_{0};
    unsigned asked_ = 0;
};

}  // namespace asip::sim
