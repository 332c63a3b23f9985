// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tests/cluster/node_engine.hpp"

namespace cluster {
namespace {

/// Three nodes, each of which holds all that is stored. A client that may publish to $JS erases retained
/// messages, so clients may not.
class Nats final : public NodeEngine {
  public:
    explicit Nats(const Hosts& hosts) : NodeEngine("nats", 3, hosts), routes_(free_ports(3)) {
        for (std::size_t i = 0; i < ports().size(); ++i)
            add_node({"/usr/sbin/nats-server", "-c", write_configuration(i)});
        wait_for_nodes();
    }
    int qos() const override { return 0; }
    std::vector<std::string> lacks() const override {
        return {"MQTT 3.1.1 only, so retained descriptions do not expire", "no dots or spaces in topics",
                "wills of a killed node are not published",
                "QoS 1 is of no use while a node is dead and 10 s after: everybody uses 0"};
    }

  private:
    std::string write_configuration(std::size_t node) const {
        std::string routes;
        for (std::size_t i = 0; i < routes_.size(); ++i)
            routes += fmt::format("nats://{}:{}, ", address(i), routes_[i]);
        return folder().write(
            fmt::format("nats{}.conf", node),
            fmt::format(R"(server_name: n{0}
listen: "127.0.0.1:-1"
max_payload: 8MB
jetstream {{ store_dir: "{1}/{0}", max_mem: 64MB, max_file: 512MB }}
cluster {{ name: asip, listen: "{5}:{2}", routes: [ {3}] }}
mqtt {{ listen: "{5}:{4}", stream_replicas: 3 }}
no_auth_user: bus
authorization {{
  users: [ {{ user: bus, password: bus, permissions: {{
    publish: {{ deny: ["$JS.>", "$MQTT.>"] }}, subscribe: {{ deny: ["$JS.>"] }} }} }} ]
}}
)",
                        node, folder().path().string(), routes_[node], routes, ports()[node], address(node)));
    }

    std::vector<std::uint16_t> routes_;
};

}  // namespace

std::unique_ptr<Engine> make_nats(const Hosts& hosts) {
    return std::make_unique<Nats>(hosts);
}

}  // namespace cluster
