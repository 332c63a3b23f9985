// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asip/client/error.hpp"
#include "asip/client/options.hpp"
#include "asip/client/transport.hpp"
#include "asip/protocol/pin.hpp"

namespace asip::client {

/// The calls of Board for a program without an event loop: each returns when it is done. A thread of its own
/// serves the connection, so that a program may sleep or compute between two calls as long as it likes; it
/// may be used from several threads. Nothing of the caller is ever called from that thread: events are
/// fetched with next_event.
class BlockingBoard {
  public:
    /// As Board::open, and returns when that would. Starts the thread.
    static Result<BlockingBoard> open(const std::string& address, Options options = {});

    /// Refers to no board: every call fails with kClosed.
    BlockingBoard();
    ~BlockingBoard();  ///< Closes the connection.
    BlockingBoard(BlockingBoard&&) noexcept;
    BlockingBoard& operator=(BlockingBoard&&) noexcept;

    // The calls below mean what those of Board with the same names mean, with the same units and errors.

    std::string name() const;
    bool online() const;
    std::vector<ServiceInfo> services() const;
    std::map<std::string, std::string> labels() const;

    Result<void> set_pin_mode(int pin, protocol::PinMode mode);
    Result<void> digital_write(int pin, bool level);
    Result<void> analog_write(int pin, int value);
    Result<bool> digital_read(int pin);
    Result<int> analog_read(int channel);
    Result<void> set_analog_period(std::chrono::milliseconds period);
    Result<void> raw(const std::string& line);

    /// `board.command("servo", "write", {0, 90})`; the decoded answer, or null.
    Result<nlohmann::json> command(const std::string& service, const std::string& name,
                                   const nlohmann::json& arguments);
    Result<nlohmann::json> command(const std::string& service, const std::string& name);

    /// As Service::values; null, too, where there is no such service.
    nlohmann::json values(const std::string& service) const;

    /// Waits until the level of an input is another one than `digital_read` returned last, or this call; the
    /// first call waits for a change from the level that it finds. Returns the new level; kTimeout where it
    /// stayed as it was. No change is missed between two calls.
    Result<bool> wait_for_change(int pin, std::chrono::milliseconds timeout);

    /// From now on, keep the events of this service for next_event: the newest 256, older ones are dropped.
    /// kInvalid if the board has no such service. `wanted_hz`: as of Service::on_event.
    Result<void> watch(const std::string& service, double wanted_hz = kUsualHz);
    /// The oldest event kept of a watched service, waiting for one at most `timeout`. kTimeout if none came;
    /// kInvalid if the service is not watched.
    Result<nlohmann::json> next_event(const std::string& service, std::chrono::milliseconds timeout);

  private:
    class Runner;
    explicit BlockingBoard(std::unique_ptr<Runner> runner);
    template <class T, class Make>
    Result<T> call(Make make) const;

    std::unique_ptr<Runner> runner_;
};

}  // namespace asip::client
