// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tests/cluster/node_engine.hpp"
#include "tests/support/child_process.hpp"

namespace cluster {
namespace {

/// Three brokers that keep everything in one Redis with a replica, of which three Sentinels choose the
/// master.
class Aedes final : public NodeEngine {
  public:
    explicit Aedes(const Hosts& hosts) : NodeEngine("aedes", 3, hosts), inner_(free_ports(5)) {
        for (std::size_t i = 0; i < 2; ++i)
            start_redis(i);
        std::string sentinels;
        for (std::size_t i = 2; i < 5; ++i) {
            start_sentinel(i);
            sentinels += fmt::format("{}{}:{}", i == 2 ? "" : ",", part_address(), inner_[i]);
        }
        for (std::size_t i = 0; i < ports().size(); ++i)
            add_node({"node", ASIP_AEDES "/broker.mjs", address(i), std::to_string(ports()[i]), sentinels},
                     {{"NODE_PATH", ASIP_AEDES_MODULES}});
        wait_for_nodes();
    }
    std::vector<std::string> lacks() const override {
        return {"MQTT 3.1.1 only, so retained descriptions do not expire",
                "wills of a killed node are published late or never"};
    }
    std::string part() const override { return "redis master"; }
    bool part_joins_nodes() const override { return true; }
    void kill_part() override {
        killed_ = master();
        helper(killed_).kill();
    }
    void start_part() override { helper(killed_).start(); }

  private:
    std::size_t master() const {
        const auto asked =
            asip::test::run({"redis-cli", "-h", part_address(), "-p", std::to_string(inner_[2]), "sentinel",
                             "get-master-addr-by-name", "asip"});
        return asked.output.find(std::to_string(inner_[1])) == std::string::npos ? 0 : 1;
    }

    void start_redis(std::size_t i) {
        const auto store = folder().path() / fmt::format("redis{}", i);
        std::filesystem::create_directories(store);
        Command command{"redis-server",
                        "--port",
                        std::to_string(inner_[i]),
                        "--bind",
                        part_address(),
                        "--dir",
                        store.string(),
                        "--protected-mode",
                        "no",
                        "--appendonly",
                        "yes",
                        "--appendfsync",
                        "everysec",
                        "--save",
                        ""};
        if (i > 0) command.insert(command.end(), {"--replicaof", part_address(), std::to_string(inner_[0])});
        add_helper(std::move(command));
        wait_for_port(part_address(), inner_[i], last_helper());
    }

    void start_sentinel(std::size_t i) {
        const auto file =
            folder().write(fmt::format("sentinel{}.conf", i),
                           fmt::format(R"(port {0}
protected-mode no
bind {3}
dir {1}
sentinel monitor asip {3} {2} 2
sentinel down-after-milliseconds asip 2000
sentinel failover-timeout asip 6000
)",
                                       inner_[i], folder().path().string(), inner_[0], part_address()));
        add_helper({"redis-sentinel", file});
        wait_for_port(part_address(), inner_[i], last_helper());
    }

    std::size_t killed_ = 0;
    std::vector<std::uint16_t> inner_;  // master, replica, three Sentinels
};

}  // namespace

std::unique_ptr<Engine> make_aedes(const Hosts& hosts) {
    return std::make_unique<Aedes>(hosts);
}

}  // namespace cluster
