// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/node_engine.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tests/support/wait.hpp"

namespace cluster {

namespace test = asip::test;
using namespace std::chrono_literals;

std::vector<std::uint16_t> free_ports(std::size_t count) {
    std::vector<std::uint16_t> ports;
    while (ports.size() < count) {
        const auto port = test::free_port();
        if (std::find(ports.begin(), ports.end(), port) == ports.end()) ports.push_back(port);
    }
    return ports;
}

NodeEngine::NodeEngine(std::string name, std::size_t nodes)
    : name_(std::move(name)), ports_(free_ports(nodes)) {}

void NodeEngine::add_node(Command command, Environment environment) {
    nodes_.push_back(std::make_unique<Process>(std::move(command), std::move(environment)));
}

void NodeEngine::add_helper(Command command, Environment environment) {
    helpers_.push_back(std::make_unique<Process>(std::move(command), std::move(environment)));
}

void NodeEngine::wait_for_port(std::uint16_t port, const Process& process) {
    if (!test::wait_until([&] { return test::accepts(port); }, 90s))
        throw std::runtime_error("does not start: " + process.log());
}

void NodeEngine::wait_for_nodes() const {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
        wait_for_port(ports_[i], *nodes_[i]);
}

}  // namespace cluster
