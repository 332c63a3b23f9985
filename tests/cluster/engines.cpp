// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <stdexcept>

#include "tests/cluster/engine.hpp"
#include "tests/cluster/process.hpp"
#include "tests/support/mosquitto_broker.hpp"
#include "tests/support/temp_dir.hpp"

namespace cluster {
namespace {

namespace test = asip::test;

/// One Mosquitto that stores nothing.
class Mosquitto final : public Engine {
  public:
    std::string name() const override { return "mosquitto"; }
    std::vector<std::uint16_t> ports() const override { return {broker_.port()}; }
    void kill(std::size_t) override { broker_.kill(); }
    void start(std::size_t) override { broker_.start(); }
    void stop(std::size_t) override { broker_.freeze(); }
    void go_on(std::size_t) override { broker_.thaw(); }
    std::string log(std::size_t) const override { return broker_.log(); }

  private:
    test::MosquittoBroker broker_{test::MosquittoBroker::Options{
        .log_type = "notice\nlog_type warning\nlog_type error", .extra_lines = {"max_queued_messages 0"}}};
};

/// Three nodes, each of which holds all that is stored. Whoever may publish to $JS erases retained messages,
/// so clients may not.
class Nats final : public Engine {
  public:
    Nats() {
        for (auto& node : nodes_)
            node = {.mqtt = test::free_port(), .cluster = test::free_port(), .process = nullptr};
        for (std::size_t i = 0; i < nodes_.size(); ++i)
            nodes_[i].process = std::make_unique<Process>(
                std::vector<std::string>{"/usr/sbin/nats-server", "-c", write_configuration(i)});
        for (const auto& node : nodes_)
            if (!test::wait_until([&] { return test::accepts(node.mqtt); }))
                throw std::runtime_error("nats-server does not start: " + node.process->log());
    }

    std::string name() const override { return "nats"; }
    std::vector<std::uint16_t> ports() const override {
        return {nodes_[0].mqtt, nodes_[1].mqtt, nodes_[2].mqtt};
    }
    std::vector<std::string> lacks() const override {
        return {"MQTT 3.1.1 only, so retained descriptions do not expire", "no dots or spaces in topics",
                "wills of a killed node are not published",
                "subscriptions with QoS 1 are refused while a node is dead"};
    }
    void kill(std::size_t node) override { nodes_.at(node).process->kill(); }
    void start(std::size_t node) override { nodes_.at(node).process->start(); }
    void stop(std::size_t node) override { nodes_.at(node).process->stop(); }
    void go_on(std::size_t node) override { nodes_.at(node).process->go_on(); }
    std::string log(std::size_t node) const override { return nodes_.at(node).process->log(); }

  private:
    struct Node {
        std::uint16_t mqtt = 0, cluster = 0;
        std::unique_ptr<Process> process;
    };

    std::string write_configuration(std::size_t node) const {
        std::string routes;
        for (const auto& other : nodes_)
            routes += fmt::format("nats://127.0.0.1:{}, ", other.cluster);
        return folder_.write(
            fmt::format("nats{}.conf", node),
            fmt::format(R"(server_name: n{0}
listen: "127.0.0.1:-1"
max_payload: 8MB
jetstream {{ store_dir: "{1}/{0}", max_mem: 64MB, max_file: 512MB }}
cluster {{ name: asip, listen: "127.0.0.1:{2}", routes: [ {3}] }}
mqtt {{ listen: "127.0.0.1:{4}", stream_replicas: 3 }}
no_auth_user: bus
authorization {{
  users: [ {{ user: bus, password: bus, permissions: {{
    publish: {{ deny: ["$JS.>", "$MQTT.>"] }}, subscribe: {{ deny: ["$JS.>"] }} }} }} ]
}}
)",
                        node, folder_.path().string(), nodes_[node].cluster, routes, nodes_[node].mqtt));
    }

    test::TempDir folder_;
    std::array<Node, 3> nodes_;
};

}  // namespace

std::vector<std::string> engine_names() {
    return {"mosquitto", "nats"};
}

std::unique_ptr<Engine> make_engine(const std::string& name) {
    if (name == "mosquitto") return std::make_unique<Mosquitto>();
    if (name == "nats") return std::make_unique<Nats>();
    throw std::runtime_error(
        fmt::format("there is no engine \"{}\"; those known are: {}", name, fmt::join(engine_names(), ", ")));
}

}  // namespace cluster
