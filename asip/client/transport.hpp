// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/client/awaitable.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace asip::client {

/// How many values a second a caller wants that does not say it.
inline constexpr double kUsualHz = 10;

/// A service a board offers, as far as the caller of Board needs to know it.
struct ServiceInfo {
    std::string name;   ///< as on the bus: "distance"; its letter if no model describes it
    char id = 0;        ///< its letter on the wire
    std::string title;  ///< for a person
    /// What people call it (`asipctl label BOARD/SERVICE name=...`); empty: nothing, or not over MQTT.
    std::string label{};
};

/// What carries a board's commands and events: Board's only dependency. DirectTransport (serial, TCP) and
/// BusTransport (MQTT) implement it, tests script it. Everything happens on one executor, in one thread;
/// nothing here locks.
class Transport {
  public:
    /// What the transport reports to its Board, always on the transport's executor and never from inside a
    /// call to it.
    class Listener {
      public:
        /// One decoded event of one service, named by its model: on_event("distance", {"distance":[42,118]}).
        /// A service without a model arrives as {"tag":"e","body":"..."} under its letter.
        virtual void on_event(const std::string& service, const nlohmann::json& event) = 0;
        /// The board is there and its services are known (`true`), or it is gone (`false`): unplugged, its
        /// agent lost, the broker away. After `true` nothing reported before still holds: a board that came
        /// back may have been reset.
        virtual void on_presence(bool there) = 0;
        /// Transport::values() of this service is another one now.
        virtual void on_values(const std::string& service) { (void)service; }

      protected:
        ~Listener() = default;
    };

    virtual ~Transport() = default;
    Transport() = default;
    Transport(const Transport&) = delete;
    Transport& operator=(const Transport&) = delete;

    /// Where everything happens; valid as long as the transport.
    virtual boost::asio::any_io_executor executor() const = 0;

    /// Called once, before anything else: reaches the board and learns its services. Returns when commands
    /// can be sent, or with the reason why not (kUnreachable, kTimeout). `listener` outlives the transport or
    /// its close().
    virtual Awaitable<void> open(Listener& listener) = 0;

    /// One command, `{"write":[0,90]}` or `{"write":{"servo":0,"angle":90}}`, to a service by name; returns
    /// when the board has executed or refused it: the decoded answer of a command that has one, else null.
    virtual Awaitable<nlohmann::json> command(std::string service, nlohmann::json command) = 0;

    /// One ASIP request as it is on the wire, without newline ("I,d,13,1"); returns when it was executed or
    /// refused. kInvalid if it is not a request line.
    virtual Awaitable<void> raw(std::string line) = 0;

    /// What is known since open(); stable between two on_presence calls.
    virtual std::string board_name() const = 0;
    virtual std::vector<ServiceInfo> services() const = 0;
    /// As its agent announced them last; none where there is no agent.
    virtual std::map<std::string, std::string> labels() const { return {}; }

    /// How the properties of a service stand, by their ids, as its agent says; without those that are not
    /// known. Null where there is no agent.
    virtual nlohmann::json values(const std::string& service) const;

    /// As long as the handle lives, `hz` values a second of this service are wanted; asked of an agent that
    /// makes its board report on demand (asip-agent --reports). Null where nothing has to be asked.
    virtual std::shared_ptr<void> demand(const std::string& service, double hz) {
        (void)service;
        (void)hz;
        return nullptr;
    }

    /// Closes the port or the connection to the broker; calls in progress end with kClosed, the listener is
    /// not called any more.
    virtual void close() = 0;
};

}  // namespace asip::client
