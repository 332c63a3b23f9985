// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tests/cluster/node_engine.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace cluster {
namespace {

namespace test = asip::test;

/// What every Mosquitto here has, and a listener for all.
std::string common(const std::string& address, std::uint16_t port) {
    return fmt::format(R"(user root
log_dest stderr
log_type warning
log_type error
log_type notice
per_listener_settings false
allow_anonymous true
set_tcp_nodelay true
max_queued_messages 0
listener {} {}
)",
                       port, address);
}

std::string stored_in(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    return fmt::format("persistence true\npersistence_location {}/\nautosave_interval 1\n", folder.string());
}

std::string bridge(std::size_t node, const std::string& address, std::uint16_t port) {
    return fmt::format(R"(connection site{0}
address {1}:{2}
topic # both 1
bridge_protocol_version mqttv50
cleansession false
try_private true
notifications false
keepalive_interval 5
restart_timeout 1 2
)",
                       node, address, port);
}

/// One Mosquitto that stores nothing.
class Mosquitto final : public NodeEngine {
  public:
    explicit Mosquitto(const Hosts& hosts) : NodeEngine("mosquitto", 1, hosts) {
        add_node(
            {"/usr/sbin/mosquitto", "-c", folder().write("mosquitto.conf", common(address(0), ports()[0]))});
        wait_for_nodes();
    }
};

/// A hub and two sites, each with a bridge to it. All of them store what is retained, so a site that comes
/// back brings what it had.
class BridgedMosquitto final : public NodeEngine {
  public:
    explicit BridgedMosquitto(const Hosts& hosts) : NodeEngine("bridges", 3, hosts) {
        for (std::size_t i = 0; i < ports().size(); ++i)
            add_node({"/usr/sbin/mosquitto", "-c", write_configuration(i)});
        wait_for_nodes();
    }
    std::vector<std::string> lacks() const override {
        return {"what is retained may be older behind one bridge than behind another",
                "one client identifier may be connected at each site",
                "wills of a killed node are not published"};
    }

  private:
    static constexpr std::size_t kHub = 1;

    std::string write_configuration(std::size_t node) const {
        auto text = common(address(node), ports()[node]) + stored_in(folder().path() / std::to_string(node));
        if (node != kHub) text += bridge(node, address(kHub), ports()[kHub]);
        return folder().write(fmt::format("{}.conf", node), text);
    }
};

}  // namespace

std::unique_ptr<Engine> make_mosquitto(const Hosts& hosts) {
    return std::make_unique<Mosquitto>(hosts);
}

std::unique_ptr<Engine> make_bridged_mosquitto(const Hosts& hosts) {
    return std::make_unique<BridgedMosquitto>(hosts);
}

}  // namespace cluster
