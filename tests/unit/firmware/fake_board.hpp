// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "Asip.h"
#include "FakeHardware.h"

namespace asip {

/// The firmware's board, fresh, on the fake hardware.
class FakeBoard {
  public:
    /// `services` are added before it starts. The banner is dropped and analog events are off.
    explicit FakeBoard(std::vector<Service*> services = {}, bool strict = false);

    /// The board as it is before begin().
    static void switch_on();

    static std::uint16_t digest() { return board.digest_; }
    static void set_digest(std::uint16_t digest) { board.digest_ = digest; }
    static std::uint8_t last_millisecond() { return board.lastMs_; }
    /// Makes arguments of the bytes that a request before has left in the line.
    static void spoil_old_bytes();

    /// Sends a request and runs the board until it is still: all that it sent, or "".
    std::string ask(const std::string& line) { return send(line + "\n"); }
    std::string send(const std::string& bytes);

    /// So many passes of the loop.
    std::string run(int passes);
    /// Runs the board until it has nothing to do.
    std::string settle();
    /// Lets milliseconds pass, with a pass of the loop in each.
    std::string pass_time(unsigned milliseconds);

    hw::Fake& hardware() { return hw::fake; }
    const std::string& banner() const { return banner_; }

  private:
    std::string take();
    std::string banner_;
};

}  // namespace asip
