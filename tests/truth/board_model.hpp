// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/truth/board/firmware.hpp"
#include "tests/truth/wire.hpp"

namespace truth {

constexpr Micros kNever = std::numeric_limits<Micros>::max();

/// A line that the board read, and what it did with it.
struct BoardRead {
    Micros at = 0;
    Micros whole_at = 0;                 ///< but for its line end; it may be executed then
    std::string text;                    ///< with its checksum, without line end
    std::vector<std::uint32_t> sources;  ///< the lines of the host that its bytes came from, in order
    std::vector<Effect> effects;
    std::string reply;  ///< what the board sent while it read the line; it may end in the middle of a line
};

/// A board: the firmware, its UART with buffers of 64 bytes, its power.
class BoardModel {
  public:
    struct Reports {
        std::function<void(BoardRead)> read;
        std::function<void(std::uint32_t line, std::string text)> sent;
        std::function<void(Fault, const WireByte&)> fault;
        std::function<void(const char*)> state;
    };
    /// `silent_overrun`: bytes that find the receive buffer full vanish, as in the Arduino core; else they
    /// spoil the line, as in AsipFastSerial.h.
    BoardModel(Firmware& firmware, Wire& in, Wire& out, Dice& dice, Micros pass_time, Micros idle_pass,
               bool silent_overrun, Reports reports)
        : firmware_(firmware),
          in_(in),
          out_(out),
          dice_(dice),
          pass_time_(pass_time),
          idle_pass_(idle_pass),
          silent_overrun_(silent_overrun),
          reports_(std::move(reports)) {}

    static constexpr const char* kOff = "board off";

    /// Off, and on again at `when` (kNever: stays off). What it was about to send is lost.
    void restart(Micros now, Micros when);
    /// Its program stops until `until`; its UART goes on receiving.
    void hang(Micros now, Micros until);
    bool running(Micros now) const { return on_ && now >= hangs_until_; }

    Micros next() const;
    void run(Micros now);
    unsigned baud() const { return on_ ? firmware_.baud() : 0; }

  private:
    void receive(Micros now);
    void take(WireByte byte);
    void consume(Micros now);
    void send(Micros now, const std::string& bytes);

    Firmware& firmware_;
    Wire& in_;
    Wire& out_;
    Dice& dice_;
    Micros pass_time_;
    Micros idle_pass_;
    bool silent_overrun_;
    Reports reports_;
    Pass pass_;

    bool on_ = false;
    bool busy_ = false;
    Micros on_at_ = kNever;
    Micros hangs_until_ = 0;
    Micros last_pass_ = 0;
    Micros blocked_until_ = 0;  // waits for room in its send buffer
    std::string received_;
    std::deque<std::uint32_t> received_from_;
    BoardRead reading_;
    std::string sending_;
    std::uint32_t line_out_ = 1;
};

}  // namespace truth
