// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/board.hpp"

namespace asip::firmware {

/// An image of ours on a simulated board, for tests that speak to it line by line. All time is simulated.
class FirmwareBoard {
  public:
    /// `image` is a name as given to asip_add_image. Boots, takes the banner and turns analog events off.
    /// Throws std::runtime_error where the image cannot be run.
    explicit FirmwareBoard(const std::string& image, std::string board = "uno",
                           std::vector<sim::PartConfig> parts = {}, std::uint32_t frequency = 16'000'000);

    /// Sends a request and gives all lines that come until a fence behind it (#,? on a 0.4 board), joined by
    /// '|'; the fence's own answer is left out.
    std::string ask(std::string_view line);
    /// Lines that come within `time`.
    std::vector<std::string> lines_within(std::chrono::milliseconds time);
    /// The next line, or "(none)" after `limit`.
    std::string next_line(std::chrono::milliseconds limit = std::chrono::milliseconds(300));

    /// Steps the line up and fences; throws if the board does not follow.
    void step_up(unsigned baud);

    sim::Board& sim() { return *board_; }
    sim::Board* operator->() { return board_.get(); }
    const std::string& banner() const { return banner_; }

  private:
    std::unique_ptr<sim::Board> board_;
    std::string banner_;
    std::string fence_ = "#,E,f";
    std::string fenced_ = "@#,E,f";
};

}  // namespace asip::firmware
