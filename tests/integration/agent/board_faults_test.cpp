// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/integration/agent/fake_port.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

TEST(AgentBoard, UnpluggedAndReplugged_KnownWithinASecondAndBackWithItsModes) {
    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe(broker.port());
    Agent agent(broker, uno.port());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    ASSERT_TRUE(probe.request("asip/uno1/io/in", R"({"mode":[13,"output"]})"));
    uno.command("unplug");
    ASSERT_TRUE(wait_state(probe, "lost", time_limit(1s))) << agent.process().errors();
    const auto refused = probe.request("asip/uno1/io/in", R"({"write":[13,1]})");
    ASSERT_TRUE(refused);
    EXPECT_THAT(*refused, HasSubstr("board-not-there"));
    ASSERT_TRUE(agent.process().wait_for_errors("waiting for it")) << agent.process().errors();
    uno.command("replug");
    ASSERT_TRUE(wait_state(probe, "online", time_limit(3s))) << agent.process().errors();
    const std::string log = agent.process().errors();
    EXPECT_THAT(log, HasSubstr("board reachable again"));
    EXPECT_EQ(log.find("waiting for it"), log.rfind("waiting for it")) << log;
    const auto modes = probe.request("asip/uno1/in", "I,p");
    ASSERT_TRUE(modes);
    EXPECT_THAT(*modes, HasSubstr("@I,p,20,{6,6,1,1,1,1,1,7,7,7,7,1,1,3")) << "pin 13 is an output again";
}

TEST(AgentBoard, GarbageOfManyKinds_NextEventWorks) {
    MosquittoBroker broker;
    FakePort port;
    BusProbe probe(broker.port());
    Agent agent(broker, port.path());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    std::mt19937 random(7);
    std::string noise(20'000, ' ');
    for (char& c : noise)
        c = static_cast<char>(random());
    for (const std::string& garbage :
         {noise + "\n", std::string(10'000, 'x') + "\n", std::string("@I,a,99\n@@@\n~\n"),
          std::string("ing on ATmega328P with Services: I S D \r\n")}) {
        port.say(garbage);
        probe.clear();
        ASSERT_TRUE(wait_until([&] {
            port.say("@I,a,1,{0:320}\r\n");
            return probe.count("asip/uno1/io/out") > 0;
        })) << agent.process().errors();
    }
    // Garbage that is read while a command is under way puts it in doubt.
    EXPECT_TRUE(wait_until([&] {
        const auto reply = probe.request("asip/uno1/io/in", R"({"write":[2,1]})");
        return reply && reply->find("\"ok\"") != std::string::npos;
    }));
    EXPECT_TRUE(agent.process().wait_for_errors("garbage from the board")) << agent.process().errors();
    EXPECT_TRUE(port.executed("I,d,2,1"));
}

TEST(AgentBoard, FloodWhileTheBrokerIsSlow_OldestValuesGoAndCommandsStay) {
    MosquittoBroker broker;
    FakePort port;
    Agent agent(broker, port.path());
    {
        BusProbe probe(broker.port());
        ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    }
    broker.freeze();
    port.flood("@I,a,6,{0:111,1:222,2:333,3:444,4:555,5:666}");
    ASSERT_TRUE(agent.process().wait_for_errors("oldest values dropped", 30s)) << agent.process().errors();
    EXPECT_LT(agent.process().resident_bytes(), memory_limit(40u << 20));
    port.flood("");
    broker.thaw();
    BusProbe probe(broker.port());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    EXPECT_TRUE(wait_until([&] {
        const auto reply = probe.request("asip/uno1/io/in", R"({"write":[2,1]})", time_limit(2s));
        return reply && reply->find("\"ok\"") != std::string::npos;
    })) << agent.process().errors();
}

TEST(AgentBoard, SilentPort_EndsWithStatus5AndSaysWhatToDo) {
    MosquittoBroker broker;
    FakePort port(false);
    const auto ended = run(agent_command(broker.url(), port.path(), {"--patience", "1"}));
    EXPECT_EQ(ended.status, 5);
    EXPECT_THAT(ended.errors, HasSubstr("does not answer"));
}

TEST(AgentBoard, OverTcp_IsOnlineAndBackWhenItsPortIs) {
    MosquittoBroker broker;
    TempDir folder;
    const auto port = std::to_string(free_port());
    const auto start_board = [&] {
        return std::make_unique<ChildProcess>(std::vector<std::string>{
            ASIP_PROGRAMS "/asip-sim", ASIP_IMAGES "/asip_uno.elf", "--tcp", port, "--no-socket"});
    };
    auto board = start_board();
    BusProbe probe(broker.port());
    ChildProcess agent({ASIP_PROGRAMS "/asip-agent", "--tcp", "127.0.0.1:" + port, "--broker", broker.url(),
                        "--name", "uno1"});
    ASSERT_TRUE(wait_state(probe, "online")) << agent.errors();
    board.reset();
    ASSERT_TRUE(wait_state(probe, "lost", time_limit(2s))) << agent.errors();
    board = start_board();
    EXPECT_TRUE(wait_state(probe, "online")) << agent.errors();
}

TEST(AgentOptions, BadOnes_EndWithStatus2) {
    EXPECT_EQ(run({ASIP_PROGRAMS "/asip-agent"}).status, 2);
    EXPECT_EQ(run({ASIP_PROGRAMS "/asip-agent", "--tcp", "127.0.0.1:0"}).status, 2);
    EXPECT_EQ(run({ASIP_PROGRAMS "/asip-agent", "--serial", "/dev/null", "--name", "a/b"}).status, 2);
    EXPECT_EQ(run({ASIP_PROGRAMS "/asip-agent", "--serial", "/dev/null", "--config",
                   settings_file("reset = maybe\n")})
                  .status,
              2);
    const auto help = run({ASIP_PROGRAMS "/asip-agent", "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.output, HasSubstr("Examples:"));
}

TEST(AgentService, PortThatIsNone_IsAskedAgainAndAStopEndsItAtOnce) {
    for (const std::map<std::string, std::string>& manager :
         {std::map<std::string, std::string>{{"NOTIFY_SOCKET", "/nonexistent/socket"}},
          {{"INVOCATION_ID", "1"}}}) {
        ChildProcess agent({ASIP_PROGRAMS "/asip-agent", "--serial", "/dev/null", "--name", "uno1"}, manager);
        ASSERT_TRUE(agent.wait_for_errors("waiting for it .*/dev/null is not a serial port"))
            << agent.errors();
        EXPECT_TRUE(agent.running());
        agent.signal(15);
        EXPECT_EQ(agent.wait_exit(), 0);
    }
}

TEST(AgentService, PortThatIsNoPortOfThisMachine_IsRefusedWithWhatToWrite) {
    for (const auto& [port, advice] : std::vector<std::pair<std::string, std::string>>{
             {"COM3", "/dev/ttyACM0"},
             {"socket://pi:6789", "--tcp pi:6789"},
             {"ttyACM0", "/dev/ttyACM0"},
             {"/dev/ttyUSB0,115200", "--baud 115200, behind --serial /dev/ttyUSB0"},
             {"/dev/ttyACM0:9600", "--baud 9600, behind --serial /dev/ttyACM0"},
             {"/dev", "/dev is a folder"}}) {
        const auto ended = run({ASIP_PROGRAMS "/asip-agent", "--serial", port});
        EXPECT_EQ(ended.status, 2) << port;
        EXPECT_THAT(ended.errors, HasSubstr(advice)) << port;
    }
}

}  // namespace
}  // namespace asip::test
