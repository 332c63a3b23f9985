// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/client/awaitable.hpp"

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "asip/client/error.hpp"
#include "asip/client/options.hpp"
#include "asip/client/stream.hpp"
#include "asip/client/transport.hpp"
#include "asip/protocol/pin.hpp"

namespace asip::client {

class Service;

/// One board, whatever carries it: a serial port, a TCP connection or an MQTT broker. The calls, their
/// answers and their errors are the same over each.
///
/// A Board is a handle: copies refer to the same board, the last one closes it. A default-constructed one
/// refers to none; every call on it fails with kClosed. All calls are made from the one thread that runs the
/// io_context it was opened on; a program without an io_context of its own uses BlockingBoard.
///
/// A call that changes something returns when the board has executed it, which a fence behind the command
/// proves. A call in progress when the board goes away ends with kUnreachable; the Board itself stays usable
/// and works again once the board is back. Pin modes and periods that were set are then set again; output
/// values never are.
class Board {
  public:
    Board() = default;
    /// Opens a board. Returns once the board is there and its services are known. `address` as parse_address
    /// takes it: "/dev/ttyACM0", "tcp://host:6789", "mqtt://broker/uno1", "uno1". `io` outlives the board;
    /// `address` and `options` are copied before this returns. Errors: kInvalid (address or topic root),
    /// kUnreachable (port, broker or board is not there within Options::open_timeout).
    static Awaitable<Board> open(boost::asio::io_context& io, std::string_view address);
    static Awaitable<Board> open(boost::asio::io_context& io, std::string_view address,
                                 const Options& options);
    /// The same over a transport of the caller's, on which open() was not called yet. Errors are those of its
    /// open().
    static Awaitable<Board> open(std::unique_ptr<Transport> transport, const Options& options);

    std::string name() const;
    /// Whether the board is there now.
    bool online() const;
    /// The services that the board has, in its order; empty before it was there for the first time.
    std::vector<ServiceInfo> services() const;
    /// The labels that people gave the board (`asipctl label`), by key, as last announced. Over a serial port
    /// or TCP there are none: they are kept by the board's agent.
    std::map<std::string, std::string> labels() const;

    // Every call below may fail with kInvalid (nothing was sent), kRefused, kBoard (its error number is in
    // Error::code), kTimeout (Options::command_timeout), kUnreachable or kClosed; see Error.

    // Pins. `pin` is the number that the Arduino core uses; `channel` counts analog inputs: channel 0 is A0.

    Awaitable<void> set_pin_mode(int pin, protocol::PinMode mode) const;
    /// `level`: true is high. The pin must be in mode kOutput.
    Awaitable<void> digital_write(int pin, bool level) const;
    /// `value`: 0 to 255, the duty of a pin in mode kPwm.
    Awaitable<void> analog_write(int pin, int value) const;
    /// The level of an input. Boards report changes by themselves, so a level once reported is answered at
    /// once; the first time the board is asked. kInvalid if the pin is not an input.
    Awaitable<bool> digital_read(int pin) const;
    /// The value, 0 to 1023: the newest report if it is younger than Options::analog_max_age, else the next
    /// one; Timeout if none comes (set_analog_period starts reports, and the pin must be in mode kAnalog).
    Awaitable<int> analog_read(int channel) const;
    /// How often the board reports its analog inputs; 0 stops. At most 65535 ms.
    Awaitable<void> set_analog_period(std::chrono::milliseconds period) const;

    // Callbacks run on the io_context of the board, one at a time. They end with the Subscription that is
    // returned.

    /// `changed` is called with each level reported for the pin that differs from the one before (the first
    /// one does).
    Subscription on_digital(int pin, std::function<void(bool level)> changed) const;
    /// `reported` is called with each report of the channel.
    Subscription on_analog(int channel, std::function<void(int value)> reported) const;
    /// `changed` is called when the board goes away (false) and when it is back (true).
    Subscription on_presence(std::function<void(bool online)> changed) const;
    /// The same levels as on_digital, to be fetched one after another, none missed in between.
    Stream<bool> digital_changes(int pin) const;

    /// A service by its name on the bus ("distance", "servo"); kInvalid if the board has none of that name,
    /// with those it has in the text.
    Result<Service> service(const std::string& name) const;

    /// One ASIP request as on the wire, for what has no call here: "T,P,440,200".
    Awaitable<void> raw(std::string line) const;

    /// Lets go of the port or broker; calls in progress end with kClosed. A board that reports on demand is
    /// told that nothing is wanted of it any more, by what the io_context still runs: for a second at most.
    void close() const;

  private:
    friend class Service;
    class Core;
    explicit Board(std::shared_ptr<Core> core);
    static Awaitable<Board> open(std::shared_ptr<Core> core);
    static Awaitable<Board> fail_to_open(Error error);
    std::shared_ptr<Core> owner() const;

    std::shared_ptr<Core> core_;
};

/// One service of a board. Commands, arguments and events are those of its service model
/// (services/NAME.json).
class Service {
  public:
    /// Refers to no service; every call on it fails with kClosed.
    Service() = default;

    const ServiceInfo& info() const { return info_; }
    /// `servo.command("write", {0, 90})`, or by argument name: `servo.command("write", {{"servo", 0},
    /// {"angle", 90}})`. Returns the board's decoded answer for a command that has one, else null.
    Awaitable<nlohmann::json> command(std::string name, nlohmann::json arguments) const;
    Awaitable<nlohmann::json> command(std::string name) const;
    /// `happened` is called with each event, decoded: {"distance":[42,118]}. `wanted_hz`: where the board
    /// reports on demand, so many a second are asked of it while the subscription lives (0.001 to 1000; it
    /// may not be able to, and others may ask for more). Elsewhere it changes nothing.
    Subscription on_event(std::function<void(const nlohmann::json& event)> happened,
                          double wanted_hz = kUsualHz) const;
    /// How its properties stand, by their ids, without those that are not known: {"servo/0/angle":90},
    /// {"io/13":true}. What any program set is there, and what the board reported. Null over a serial port or
    /// TCP: an agent tells it.
    nlohmann::json values() const;
    /// `changed` is called with it each time it changes.
    Subscription on_values(std::function<void(const nlohmann::json& values)> changed) const;
    /// The same events as on_event, to be fetched one after another, none missed in between.
    Stream<nlohmann::json> events(double wanted_hz = kUsualHz) const;

  private:
    friend class Board;
    Service(std::shared_ptr<Board::Core> core, ServiceInfo info);

    std::shared_ptr<Board::Core> core_;
    ServiceInfo info_;
};

}  // namespace asip::client
