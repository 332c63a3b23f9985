// SPDX-License-Identifier: Apache-2.0
// A broker that refuses dots in topics: NATS, which makes subjects of its own of them.
#include <gmock/gmock.h>

#include <algorithm>
#include <thread>

#include "tests/integration/agent/fake_port.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class NatsServer {
  public:
    NatsServer() : port_(free_port()) {
        const auto configuration = folder_.write(
            "nats.conf", "server_name: n1\nlisten: \"127.0.0.1:-1\"\njetstream { store_dir: \"" +
                             folder_.file("store") +
                             "\" }\nmqtt { listen: \"127.0.0.1:" + std::to_string(port_) + "\" }\n");
        process_ = std::make_unique<ChildProcess>(
            std::vector<std::string>{"/usr/sbin/nats-server", "-c", configuration});
        if (!wait_until([&] { return accepts(port_) || !process_->running(); }) || !process_->running())
            throw std::runtime_error("nats-server does not start: " + process_->errors());
    }
    std::uint16_t port() const { return port_; }
    /// From 2.10 on: nats-server: v2.10.27
    static bool takes_dots() {
        const auto version = run({"/usr/sbin/nats-server", "--version"}, {}, 30s).output;
        int major = 0;
        int minor = 0;
        if (std::sscanf(version.c_str(), "nats-server: v%d.%d", &major, &minor) != 2)
            throw std::runtime_error("nats-server: what version is \"" + version + "\"?");
        return std::pair(major, minor) >= std::pair(2, 10);
    }
    std::string url() const { return "mqtt://127.0.0.1:" + std::to_string(port_); }

  private:
    TempDir folder_;
    std::uint16_t port_;
    std::unique_ptr<ChildProcess> process_;
};

Finished asipctl(const NatsServer& nats, std::vector<std::string> words) {
    words.insert(words.begin(), {ASIP_PROGRAMS "/asipctl", "--broker", nats.url()});
    return run(std::move(words), {}, 30s);
}

TEST(AgentNats, NameWithoutADot_IsOnlineAndCommanded) {
    NatsServer nats;
    SimulatedUno uno;
    BusProbe probe(nats.port(), {"asip/servicebus/#"}, {.v5 = false});
    ChildProcess agent(agent_command(nats.url(), uno.port()));
    ASSERT_TRUE(wait_state(probe, "online")) << agent.errors();
    const auto sent = asipctl(nats, {"send", "uno1/io", "write", "13", "1"});
    EXPECT_EQ(sent.status, 0) << sent.errors;
}

TEST(AgentNats, CommandedForAWhile_NoCommandIsTakenForOld) {
    NatsServer nats;
    SimulatedUno uno;
    BusProbe probe(nats.port(), {"asip/servicebus/#"}, {.v5 = false});
    ChildProcess agent(agent_command(nats.url(), uno.port()));
    ASSERT_TRUE(wait_state(probe, "online")) << agent.errors();
    const auto is_ok = [&] {
        const auto answer = probe.request("asip/uno1/io/in", R"({"write":[13,1],"deadline_ms":1000})");
        return answer && answer->find(R"("ok")") != std::string::npos;
    };
    ASSERT_TRUE(wait_until(is_ok));
    // Each check would be late, were they not answered.
    std::this_thread::sleep_for(3s);
    EXPECT_TRUE(wait_until(is_ok, 10s)) << agent.errors();
}

TEST(AgentNats, SubscriptionThatIsRefused_IsToldAtOnceInWords) {
    NatsServer nats;
    if (nats.takes_dots()) GTEST_SKIP() << "NATS takes names with dots from 2.10 on";
    for (const std::string verb : {"subscribe", "logs"}) {
        ChildProcess listener({ASIP_PROGRAMS "/asipctl", "--broker", nats.url(), verb, "lamp.1"});
        EXPECT_TRUE(
            listener.wait_for_errors("the broker does not let users without a name read "
                                     "asip/.*lamp.1.*what comes there is missing"))
            << verb << listener.errors();
        EXPECT_TRUE(listener.running()) << "told while it listens";
        listener.signal(SIGINT);
        EXPECT_EQ(listener.wait_exit(), 0) << listener.errors();
    }
}

TEST(AgentNats, NameWithADot_IsRefusedInWords) {
    NatsServer nats;
    if (nats.takes_dots()) GTEST_SKIP() << "NATS takes names with dots from 2.10 on";
    FakePort port;
    auto command = agent_command(nats.url(), port.path());
    std::replace(command.begin(), command.end(), std::string("uno1"), std::string("lamp.1"));
    ChildProcess agent(command);
    EXPECT_TRUE(
        agent.wait_for_errors("refuse topics with a dot or a space, such as asip/servicebus/lamp.1/.state: "
                              "try a name without"))
        << agent.errors();
    EXPECT_TRUE(agent.running()) << "the broker may be another one later";
}

}  // namespace
}  // namespace asip::test
