// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace cluster {

/// An MQTT engine of one or more broker nodes, as child processes on 127.0.0.1. No call waits for long.
class Engine {
  public:
    Engine() = default;
    virtual ~Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    virtual std::string name() const = 0;
    /// Ports of the nodes for MQTT.
    virtual std::vector<std::uint16_t> ports() const = 0;
    /// What the programs must do without, in words.
    virtual std::vector<std::string> lacks() const { return {}; }

    virtual void kill(std::size_t node) = 0;   ///< kill -9
    virtual void start(std::size_t node) = 0;  ///< again, on the same port, with what it had stored
    virtual void stop(std::size_t node) = 0;   ///< SIGSTOP
    virtual void go_on(std::size_t node) = 0;  ///< SIGCONT
    virtual std::string log(std::size_t node) const = 0;
};

/// "mosquitto", "bridges", "nats", "rabbitmq", "aedes"
std::vector<std::string> engine_names();
/// Started, with nodes that accept connections. Throws std::runtime_error: no such engine, or it does not
/// start.
std::unique_ptr<Engine> make_engine(const std::string& name);

}  // namespace cluster
