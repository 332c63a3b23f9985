// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tests/cluster/node_engine.hpp"

namespace cluster {
namespace {

/// Three brokers that keep everything in one Redis with a replica, of which three Sentinels choose the
/// master.
class Aedes final : public NodeEngine {
  public:
    Aedes() : NodeEngine("aedes", 3), inner_(free_ports(5)) {
        for (std::size_t i = 0; i < 2; ++i)
            start_redis(i);
        std::string sentinels;
        for (std::size_t i = 2; i < 5; ++i) {
            start_sentinel(i);
            sentinels += fmt::format("{}127.0.0.1:{}", i == 2 ? "" : ",", inner_[i]);
        }
        for (const auto port : ports())
            add_node({"node", ASIP_AEDES "/broker.mjs", std::to_string(port), sentinels},
                     {{"NODE_PATH", ASIP_AEDES_MODULES}});
        wait_for_nodes();
    }
    std::vector<std::string> lacks() const override {
        return {"MQTT 3.1.1 only, so retained descriptions do not expire",
                "wills of a killed node are published late or never"};
    }

  private:
    void start_redis(std::size_t i) {
        const auto store = folder().path() / fmt::format("redis{}", i);
        std::filesystem::create_directories(store);
        Command command{"redis-server",
                        "--port",
                        std::to_string(inner_[i]),
                        "--bind",
                        "127.0.0.1",
                        "--dir",
                        store.string(),
                        "--appendonly",
                        "yes",
                        "--appendfsync",
                        "everysec",
                        "--save",
                        ""};
        if (i > 0) command.insert(command.end(), {"--replicaof", "127.0.0.1", std::to_string(inner_[0])});
        add_helper(std::move(command));
        wait_for_port(inner_[i], last_helper());
    }

    void start_sentinel(std::size_t i) {
        const auto file = folder().write(fmt::format("sentinel{}.conf", i),
                                         fmt::format(R"(port {}
bind 127.0.0.1
dir {}
sentinel monitor asip 127.0.0.1 {} 2
sentinel down-after-milliseconds asip 2000
sentinel failover-timeout asip 6000
)",
                                                     inner_[i], folder().path().string(), inner_[0]));
        add_helper({"redis-sentinel", file});
        wait_for_port(inner_[i], last_helper());
    }

    std::vector<std::uint16_t> inner_;  // master, replica, three Sentinels
};

}  // namespace

std::unique_ptr<Engine> make_aedes() {
    return std::make_unique<Aedes>();
}

}  // namespace cluster
