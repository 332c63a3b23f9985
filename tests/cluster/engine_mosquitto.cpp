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

/// Two bridged Mosquittos behind the one address of HAProxy, which passes TLS through: the certificates are
/// the brokers'.
class Haproxy final : public NodeEngine {
  public:
    explicit Haproxy(const Hosts& hosts)
        : NodeEngine("haproxy", 2, hosts), inner_(free_ports(3)), certificates_(make_certificates()) {
        for (std::size_t i = 0; i < ports().size(); ++i)
            add_node({"/usr/sbin/mosquitto", "-c", write_broker(i)});
        wait_for_nodes();
        add_helper({"/usr/sbin/haproxy", "-db", "-f", write_proxy()});
        wait_for_port(part_address(), inner_[2], last_helper());
    }
    std::vector<asip::mqtt::BrokerAddress> brokers() const override {
        return {{.host = part_address(), .port = inner_[2], .tls = true}};
    }
    std::string ca() const override { return certificates_.ca; }
    std::vector<std::string> lacks() const override {
        return {"what is retained may be older on one broker than on the other",
                "one client identifier may be connected at each broker",
                "wills of a killed node are not published"};
    }
    std::string part() const override { return "haproxy"; }
    void kill_part() override { helper(0).kill(); }
    void start_part() override { helper(0).start(); }

  private:
    test::Certificates make_certificates() const {
        return test::make_certificates(
            folder(), {.names = fmt::format("DNS:localhost,IP:127.0.0.1,IP:{}", part_address())});
    }

    // A plain listener for the bridge, another with TLS for clients.
    std::string write_broker(std::size_t node) const {
        auto text = common(address(node), inner_[node]) + stored_in(folder().path() / std::to_string(node));
        text += fmt::format("listener {} {}\ncertfile {}\nkeyfile {}\n", ports()[node], address(node),
                            certificates_.server_cert, certificates_.server_key);
        if (node == 1) text += bridge(node, address(0), inner_[0]);
        return folder().write(fmt::format("{}.conf", node), text);
    }

    std::string write_proxy() const {
        return folder().write("haproxy.cfg", fmt::format(R"(defaults
    mode tcp
    timeout connect 2s
    timeout client 5m
    timeout server 5m
    option redispatch
frontend bus
    bind {0}:{1}
    default_backend brokers
backend brokers
    balance leastconn
    default-server check inter 500ms fall 2 rise 1 on-marked-down shutdown-sessions
    server one {2}:{3}
    server two {4}:{5}
)",
                                                         part_address(), inner_[2], address(0), ports()[0],
                                                         address(1), ports()[1]));
    }

    std::vector<std::uint16_t> inner_;  // of the bridge's two ends, of HAProxy
    test::Certificates certificates_;
};

}  // namespace

std::unique_ptr<Engine> make_mosquitto(const Hosts& hosts) {
    return std::make_unique<Mosquitto>(hosts);
}

std::unique_ptr<Engine> make_bridged_mosquitto(const Hosts& hosts) {
    return std::make_unique<BridgedMosquitto>(hosts);
}

std::unique_ptr<Engine> make_haproxy(const Hosts& hosts) {
    return std::make_unique<Haproxy>(hosts);
}

}  // namespace cluster
