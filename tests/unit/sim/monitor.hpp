// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <string_view>

#include "sim/board.hpp"

namespace asip::sim {

/// A new folder that goes away with its object.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

  private:
    std::filesystem::path path_;
};

void write_file(const std::filesystem::path& file, std::string_view content);

/// A board that runs sketches/monitor.c and has said hello.
class Monitor {
  public:
    explicit Monitor(std::vector<PartConfig> parts = {}, const std::string& board = "uno");
    explicit Monitor(BoardConfig config);
    static BoardConfig config(const std::string& board = "uno");

    Board* operator->() { return board_.get(); }
    Board& board() { return *board_; }

    /// Sends a command and waits until it is on the chip.
    void send(std::string_view command);
    /// Sends a command and gives the `count` bytes that it answers; fewer if they do not come.
    std::string ask(std::string_view command, std::size_t count);
    unsigned ask_word(std::string_view command);

    void write_register(unsigned address, unsigned value);
    unsigned read_register(unsigned address);

  private:
    std::unique_ptr<Board> board_;
};

// Registers of the ATmega328P, as addresses in the data space. PB5 is pin 13, PD2 pin 2, PD3 pin 3, PD4
// pin 4.
constexpr unsigned kDdrB = 0x24, kPortB = 0x25;
constexpr unsigned kPinD = 0x29, kDdrD = 0x2a, kPortD = 0x2b;

}  // namespace asip::sim
