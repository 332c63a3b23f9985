// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tests/cluster/node_engine.hpp"
#include "tests/support/mosquitto_broker.hpp"

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

/// A hub and two sites, each with a bridge to it. All of them store what is retained, so a site that comes
/// back brings what it had.
class BridgedMosquitto final : public NodeEngine {
  public:
    BridgedMosquitto() : NodeEngine("bridges", 3) {
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
        const auto store = folder().path() / std::to_string(node);
        std::filesystem::create_directories(store);
        auto text = fmt::format(R"(user root
log_dest stderr
log_type warning
log_type error
log_type notice
listener {} 127.0.0.1
allow_anonymous true
set_tcp_nodelay true
max_queued_messages 0
persistence true
persistence_location {}/
autosave_interval 1
)",
                                ports()[node], store.string());
        if (node != kHub)
            text += fmt::format(R"(connection site{0}
address 127.0.0.1:{1}
topic # both 1
bridge_protocol_version mqttv50
cleansession false
try_private true
notifications false
keepalive_interval 5
restart_timeout 1
)",
                                node, ports()[kHub]);
        return folder().write(fmt::format("{}.conf", node), text);
    }
};

}  // namespace

std::unique_ptr<Engine> make_mosquitto() {
    return std::make_unique<Mosquitto>();
}

std::unique_ptr<Engine> make_bridged_mosquitto() {
    return std::make_unique<BridgedMosquitto>();
}

}  // namespace cluster
