// SPDX-License-Identifier: Apache-2.0
// The helpers themselves: a test that leans on them must be able to trust them.
#include <gtest/gtest.h>

#include <csignal>
#include <stdexcept>

#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {
namespace {

TEST(Support, ProbeDropped_LeavesItsWill) {
    MosquittoBroker broker;
    BusProbe watcher(broker.port());
    BusProbe::Options options;
    options.will = mqtt::Message{.topic = "gone", .payload = "lost"};
    BusProbe probe(broker.port(), {}, options);
    probe.drop();
    EXPECT_TRUE(watcher.wait_for("gone", "lost"));
    EXPECT_FALSE(probe.connected());
}

TEST(Support, RequestOverBothVersions_FindsItsAnswer) {
    MosquittoBroker broker;
    for (const bool v5 : {true, false}) {
        BusProbe server(broker.port(), {"service"});
        BusProbe asker(broker.port(), {}, {.v5 = v5});
        EXPECT_EQ(asker.request("service", "{}", 50ms), std::nullopt);
        const auto asked = server.wait_for("service");
        ASSERT_TRUE(asked);
        EXPECT_EQ(asked->response_topic.empty(), !v5);
        EXPECT_EQ(asked->payload.find("reply_to") == std::string::npos, v5);
    }
}

TEST(Support, BrokerWithPersistence_KeepsRetainedThroughRestart) {
    MosquittoBroker broker({.persistence = true});
    {
        BusProbe probe(broker.port());
        probe.publish("kept", "x", true);
        ASSERT_TRUE(wait_until([&] { return probe.all_acknowledged(); }));
    }
    broker.stop();
    broker.start();
    BusProbe probe(broker.port());
    EXPECT_TRUE(probe.wait_for("kept", "x"));
}

TEST(Support, ProbeWithWrongPassword_Throws) {
    MosquittoBroker broker({.users = {{"ada", "right"}}});
    EXPECT_THROW(BusProbe(broker.port(), {}, {.user = "ada", .password = "wrong"}), std::runtime_error);
    EXPECT_NO_THROW(BusProbe(broker.port(), {}, {.user = "ada", .password = "right"}));
}

TEST(Support, ChildProcess_OutputInputStatusAndSignal) {
    ChildProcess cat({"cat"});
    cat.write_input("hello\nworld\n");
    EXPECT_EQ(cat.wait_for_output("wor"), "world");
    cat.signal(SIGTERM);
    EXPECT_EQ(cat.wait_exit(), 128 + SIGTERM);
    const auto failed = run({"sh", "-c", "echo out; echo err >&2; exit 3"});
    EXPECT_EQ(failed.status, 3);
    EXPECT_EQ(failed.output, "out\n");
    EXPECT_EQ(failed.errors, "err\n");
    EXPECT_EQ(run({"sleep", "60"}, {}, 50ms).status, -1);
    EXPECT_THROW(ChildProcess({"/no/such/program"}), std::runtime_error);
}

TEST(Support, ChildProcess_InheritsNoSettingsOfOurs) {
    setenv("ASIP_BROKER", "from-outside", 1);
    EXPECT_EQ(run({"sh", "-c", "echo $ASIP_BROKER-$ASIP_USER"}, {{"ASIP_USER", "ada"}}).output, "-ada\n");
    unsetenv("ASIP_BROKER");
}

TEST(Support, ChildOfChild_IsGoneWithIt) {
    std::optional<std::string> line;
    {
        ChildProcess shell({"sh", "-c", "sleep 1000 & echo pid $!; wait"});
        line = shell.wait_for_output("pid [0-9]+");
        ASSERT_TRUE(line);
    }
    const auto pid = static_cast<pid_t>(std::stoi(line->substr(4)));
    EXPECT_TRUE(wait_until([&] { return ::kill(pid, 0) != 0; }));
}

}  // namespace
}  // namespace asip::test
