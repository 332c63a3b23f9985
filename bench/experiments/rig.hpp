// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "asip/client/board.hpp"
#include "bench/experiments/results.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"

#include <boost/asio/co_spawn.hpp>

namespace asip::experiments {

/// A firmware image that is measured, and how it is called in tables.
struct Firmware {
    std::string name;
    std::string image;
};

/// Ours, and the other one if there is one.
std::vector<Firmware> firmwares(const std::string& other_image);

/// Simulated Unos in one asip-sim, in real time.
class Simulator {
  public:
    struct Board {
        std::string name;
        std::string image;  ///< an .elf file
        std::string parts;  ///< JSON array
    };
    explicit Simulator(const std::vector<Board>& boards);

    std::string port(const std::string& board) const { return folder_.file(board); }
    /// A command of asip-sim: "press desk/button".
    void command(const std::string& line) { process_->write_input(line + "\n"); }
    test::ChildProcess& process() { return *process_; }
    /// How often the computer could not keep up with a board.
    unsigned times_behind() const;

  private:
    test::TempDir folder_;
    std::unique_ptr<test::ChildProcess> process_;
};

enum class Link { kSerial, kTcp, kMqtt };
const char* name_of(Link link);

/// Rate that boards are stepped up to.
inline constexpr unsigned kFastBaud = 500'000;

/// What is between a program and a board's serial port: nothing, an agent's TCP server, or an agent and a
/// broker.
class Way {
  public:
    /// `fast`: the line is stepped up where the board can. Returns once the agent, if there is one, has its
    /// board.
    Way(const test::MosquittoBroker& broker, Link link, bool fast, const std::string& port,
        const std::string& board);

    const std::string& address() const { return address_; }
    client::Options options() const;
    /// Whether the line runs faster than 57600 baud now, as far as an agent reported it.
    bool agent_stepped_up() const { return stepped_up_; }

  private:
    bool fast_;
    bool stepped_up_ = false;
    std::string address_;
    std::unique_ptr<test::ChildProcess> agent_;
};

/// Runs the loop until `condition` holds. False: it did not within `limit`.
bool run_until(boost::asio::io_context& io, const std::function<bool()>& condition,
               std::chrono::milliseconds limit);

/// Runs the loop until the call has ended; throws std::runtime_error with its error.
template <class T>
T finish(boost::asio::io_context& io, client::Awaitable<T> call) {
    std::optional<client::Result<T>> result;
    boost::asio::co_spawn(io, std::move(call),
                          [&](std::exception_ptr, client::Result<T> ended) { result = std::move(ended); });
    run_until(io, [&] { return result.has_value(); }, std::chrono::seconds(30));
    if (!result) throw std::runtime_error("no answer in 30 s");
    if (!*result) throw std::runtime_error(to_string(result->error()));
    if constexpr (!std::is_void_v<T>) return std::move(**result);
}

std::string number(double value, int decimals);

/// Adds a note to results that a busy computer has spoilt.
void note_behind(Results& results, unsigned times_behind);

}  // namespace asip::experiments
