// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/node_engine.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <stdexcept>
#include <utility>

#include "tests/cluster/network.hpp"
#include "tests/support/wait.hpp"

namespace cluster {

namespace asio = boost::asio;
namespace test = asip::test;
using namespace std::chrono_literals;

namespace {

constexpr auto kStarts = 300s;  // RabbitMQ needs 20, on a busy machine many times as many

bool accepts(const std::string& address, std::uint16_t port) {
    asio::io_context io;
    asio::ip::tcp::socket socket(io);
    boost::system::error_code error;
    socket.connect({asio::ip::make_address(address), port}, error);
    return !error;
}

}  // namespace

std::vector<std::uint16_t> free_ports(std::size_t count) {
    std::vector<std::uint16_t> ports;
    while (ports.size() < count) {
        const auto port = test::free_port();
        if (std::find(ports.begin(), ports.end(), port) == ports.end()) ports.push_back(port);
    }
    return ports;
}

std::string Hosts::address(std::size_t host) const {
    return network != nullptr ? Network::address(host) : "127.0.0.1";
}

std::vector<std::string> Hosts::inside(std::size_t host, std::vector<std::string> command) const {
    return network != nullptr ? network->inside(host, std::move(command)) : command;
}

NodeEngine::NodeEngine(std::string name, std::size_t nodes, const Hosts& hosts)
    : name_(std::move(name)), hosts_(hosts), ports_(free_ports(nodes)) {}

std::vector<asip::mqtt::BrokerAddress> NodeEngine::brokers() const {
    std::vector<asip::mqtt::BrokerAddress> all;
    for (std::size_t i = 0; i < ports_.size(); ++i)
        all.push_back({.host = address(i), .port = ports_[i]});
    return all;
}

void NodeEngine::add_node(Command command, Environment environment) {
    command = hosts_.inside(Hosts::kFirstNode + nodes_.size(), std::move(command));
    nodes_.push_back(std::make_unique<Process>(std::move(command), std::move(environment)));
}

void NodeEngine::add_helper(Command command, std::size_t node, Environment environment) {
    command = hosts_.inside(Hosts::kFirstNode + node, std::move(command));
    helpers_.push_back(std::make_unique<Process>(std::move(command), std::move(environment)));
}

void NodeEngine::run_helper(Command command, std::size_t node, Environment environment) {
    add_helper(std::move(command), node, std::move(environment));
    Process& helper = *helpers_.back();
    test::wait_until([&] { return helper.ended_by_itself().has_value(); }, kStarts);
    if (helper.ended_by_itself() != 0) throw std::runtime_error("a command failed: " + helper.log());
}

void NodeEngine::wait_for_port(const std::string& address, std::uint16_t port, const Process& process) {
    if (!test::wait_until([&] { return accepts(address, port); }, kStarts))
        throw std::runtime_error("does not start: " + process.log());
}

void NodeEngine::wait_for_nodes() const {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
        wait_for_port(address(i), ports_[i], *nodes_[i]);
}

}  // namespace cluster
