// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "asip/mqtt/options.hpp"

namespace cluster {

class Network;

/// The hosts of a network on which everything runs; without one all of it runs on 127.0.0.1.
struct Hosts {
    static constexpr std::size_t kFirstNode = 3, kMaxNodes = 3;
    const Network* network = nullptr;

    std::string address(std::size_t host) const;
    /// The command inside the host, where there are hosts.
    std::vector<std::string> inside(std::size_t host, std::vector<std::string> command) const;
};

/// An MQTT engine of one or more broker nodes, as child processes. No call waits for long.
class Engine {
  public:
    Engine() = default;
    virtual ~Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    virtual std::string name() const = 0;
    /// Where programs connect to. Not always the nodes.
    virtual std::vector<asip::mqtt::BrokerAddress> brokers() const = 0;
    virtual std::size_t nodes() const = 0;
    /// What the programs must do without, in words.
    virtual std::vector<std::string> lacks() const { return {}; }

    virtual void kill(std::size_t node) = 0;   ///< kill -9
    virtual void start(std::size_t node) = 0;  ///< again, on the same port, with what it had stored
    virtual void stop(std::size_t node) = 0;   ///< SIGSTOP
    virtual void go_on(std::size_t node) = 0;  ///< SIGCONT
    virtual std::string log(std::size_t node) const = 0;
};

/// "mosquitto", "bridges", "rabbitmq"
std::vector<std::string> engine_names();
/// Started, with nodes that accept connections. Throws std::runtime_error: no such engine, or it does not
/// start.
std::unique_ptr<Engine> make_engine(const std::string& name, const Hosts& hosts);

}  // namespace cluster
