// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/cluster/engine.hpp"
#include "tests/cluster/process.hpp"
#include "tests/support/temp_dir.hpp"

namespace cluster {

/// An engine each node of which is one process that listens for MQTT. What else it needs runs beside, and is
/// not killed with a node.
class NodeEngine : public Engine {
  public:
    std::string name() const final { return name_; }
    std::vector<asip::mqtt::BrokerAddress> brokers() const override;
    std::size_t nodes() const final { return ports_.size(); }
    void kill(std::size_t node) final { nodes_.at(node)->kill(); }
    void start(std::size_t node) final { nodes_.at(node)->start(); }
    void stop(std::size_t node) final { nodes_.at(node)->stop(); }
    void go_on(std::size_t node) final { nodes_.at(node)->go_on(); }
    std::string log(std::size_t node) const final { return nodes_.at(node)->log(); }

  protected:
    using Command = std::vector<std::string>;
    using Environment = std::map<std::string, std::string>;

    /// With so many nodes, whose ports are chosen.
    NodeEngine(std::string name, std::size_t nodes, const Hosts& hosts);
    const std::vector<std::uint16_t>& ports() const { return ports_; }
    /// The host of a node.
    std::string address(std::size_t node) const { return hosts_.address(Hosts::kFirstNode + node); }
    bool networked() const { return hosts_.network != nullptr; }
    const asip::test::TempDir& folder() const { return folder_; }
    /// The next node.
    void add_node(Command command, Environment environment = {});
    /// A process that runs on the host of a node, and is not killed with it.
    void add_helper(Command command, std::size_t node, Environment environment = {});
    /// Runs a command to its end on the host of a node. Throws std::runtime_error with its log when it fails.
    void run_helper(Command command, std::size_t node, Environment environment);
    /// Until each node accepts connections. Throws std::runtime_error with the log of one that does not.
    void wait_for_nodes() const;
    static void wait_for_port(const std::string& address, std::uint16_t port, const Process& process);
    const Process& last_helper() const { return *helpers_.back(); }

  private:
    asip::test::TempDir folder_;
    std::string name_;
    Hosts hosts_;
    std::vector<std::uint16_t> ports_;
    std::vector<std::unique_ptr<Process>> helpers_;
    std::vector<std::unique_ptr<Process>> nodes_;  // before the helpers at the end
};

/// For these tests alone: free now, and different from each other.
std::vector<std::uint16_t> free_ports(std::size_t count);

std::unique_ptr<Engine> make_mosquitto(const Hosts& hosts);
std::unique_ptr<Engine> make_bridged_mosquitto(const Hosts& hosts);
std::unique_ptr<Engine> make_rabbitmq(const Hosts& hosts);

}  // namespace cluster
