// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "cli/doctor/findings.hpp"
#include "cli/flash/no_asip.hpp"
#include "tests/unit/cli/boards.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

using Level = Finding::Level;

std::vector<std::string> topics_of(const std::vector<Lingering>& all) {
    std::vector<std::string> result;
    for (const auto& one : all)
        result.push_back(one.topic);
    return result;
}

const bus::Topics kTopics("asip");

TEST(FindLingering, LivingBoardAndStrangersOwnTopics_AreLeftAlone) {
    EXPECT_THAT(find_lingering(kTopics, {{"asip/servicebus/uno1/$state", "online"},
                                         {"asip/servicebus/uno1/$description", kUno1},
                                         {"asip/uno1/distance/out", "{}"},
                                         {"asip/registry/r1/$state", "online"},
                                         {"asip/registry/r1/$stats", "{}"},
                                         {"asip/somebody/else/keeps/this", "1"}}),
                IsEmpty());
}

TEST(FindLingering, GoneBoardsCommandsOrphansNamesAndRegistries_AreFound) {
    const auto all = find_lingering(kTopics, {{"asip/servicebus/dead/$state", "lost"},
                                              {"asip/dead/distance/out", "{}"},
                                              {"asip/servicebus/ghost/$state", "online"},
                                              {"asip/servicebus/uno1/$state", "online"},
                                              {"asip/servicebus/uno1/$description", kUno1},
                                              {"asip/uno1/in", "#,R"},
                                              {"asip/uno1/servo/in", "W,0,90"},
                                              {"asip/nobody/out", "x"},
                                              {"asip/servicebus/a b/$state", "online"},
                                              {"asip/registry/r1/$stats", "{}"}});
    EXPECT_THAT(topics_of(all),
                ElementsAre("asip/dead/distance/out", "asip/nobody/out", "asip/registry/r1/$stats",
                            "asip/servicebus/a b/$state", "asip/servicebus/dead/$state",
                            "asip/servicebus/ghost/$state", "asip/uno1/in", "asip/uno1/servo/in"));
    EXPECT_EQ(all[5].kind, Lingering::Kind::kGoneBoard);
    EXPECT_EQ(all[5].why, "its lease ran out");
    EXPECT_EQ(all[6].kind, Lingering::Kind::kCommand);
}

/// Each would be executed by a program that subscribes, whenever it does.
TEST(FindLingering, RetainedRequestsOfEveryKind_AreCommands) {
    const std::vector<std::string> requests{"asip/export/ha/uno1/io-13/set",
                                            "asip/registry/forget",
                                            "asip/registry/query",
                                            "asip/registry/r1/forget",
                                            "asip/registry/r1/query",
                                            "asip/servicebus/$probe",
                                            "asip/uno1/$stop",
                                            "asip/uno1/in",
                                            "asip/uno1/servo/in"};
    std::vector<Retained> all{{"asip/servicebus/uno1/$state", "online"},
                              {"asip/servicebus/uno1/$description", kUno1},
                              {"asip/uno1/servo/set", "{}"},
                              {"asip/export/dashboard/lab", "{}"}};
    for (const auto& topic : requests)
        all.push_back({topic, "x"});
    const auto found = find_lingering(kTopics, all);
    EXPECT_EQ(topics_of(found), requests);
    for (const auto& one : found)
        EXPECT_EQ(one.kind, Lingering::Kind::kCommand) << one.topic;
}

TEST(TopicsOfBoard, NameThatBeginsAnother_TakesOnlyItsOwn) {
    const std::vector<Retained> all{{"asip/servicebus/uno1/$state", "lost"},
                                    {"asip/servicebus/uno11/$state", "lost"},
                                    {"asip/uno1/io/out", "{}"},
                                    {"asip/uno11/io/out", "{}"}};
    EXPECT_THAT(topics_of_board(kTopics, all, "uno1"),
                ElementsAre("asip/servicebus/uno1/$state", "asip/uno1/io/out"));
    EXPECT_FALSE(seems_alive(kTopics, all, "uno1"));
}

Observations healthy() {
    Observations seen;
    seen.broker = "mqtt://127.0.0.1:1883";
    seen.max_packet_bytes = 1u << 20;
    seen.acknowledged = 200us;
    seen.registry = "r1";
    seen.retained = {{"asip/servicebus/uno1/$state", "online"}, {"asip/servicebus/uno1/$description", kUno1}};
    seen.boards = {announced()};
    seen.boards[0].age = 1;
    seen.asked = seen.answered = std::chrono::system_clock::time_point(1'700'000'000s);
    seen.boards[0].last_seen = std::chrono::floor<std::chrono::milliseconds>(seen.asked - 1s);
    seen.pings["uno1"].reply = bus::Reply::ok("answer");
    return seen;
}

/// What is wrong, without what is fine.
std::vector<std::string> problems(const Findings& findings) {
    std::vector<std::string> result;
    for (const auto& finding : findings) {
        if (finding.level == Level::kFine) continue;
        EXPECT_FALSE(finding.advice.empty()) << finding.what;
        result.push_back(finding.what);
    }
    return result;
}

TEST(Doctor, HealthyBus_HasNoProblems) {
    EXPECT_THAT(problems(check_all(healthy())), IsEmpty());
    EXPECT_FALSE(has_problem(check_all(healthy())));
}

TEST(Doctor, SlowAcknowledgement_PointsAtTcpNodelay) {
    auto seen = healthy();
    seen.acknowledged = 44ms;
    const auto findings = check_broker(seen);
    EXPECT_FALSE(has_problem(findings)) << "everything works";
    EXPECT_THAT(findings.back().what, HasSubstr("TCP_NODELAY"));
    EXPECT_THAT(findings.back().advice, HasSubstr("set_tcp_nodelay true"));
}

TEST(Doctor, OpenBus_IsANoteOnThisMachineAndAProblemElsewhere) {
    auto seen = healthy();
    seen.open = true;
    seen.loopback = true;
    EXPECT_FALSE(has_problem(check_broker(seen)));
    EXPECT_THAT(check_broker(seen)[1].advice, HasSubstr("asipctl secure init"));
    seen.loopback = false;
    EXPECT_THAT(problems(check_broker(seen)), ElementsAre(HasSubstr("the bus is open")));
    seen.open = false;
    EXPECT_THAT(problems(check_broker(seen)), IsEmpty());
    EXPECT_THAT(check_broker(seen)[1].what, HasSubstr("known users only"));
}

TEST(Doctor, LimitOfTheBrokerThatIsNotBelowOurs_IsReportedWithTheLineToAdd) {
    auto seen = healthy();
    for (const std::size_t limit : {0u, 2u << 20, (2u << 20) - 100'000u, 268'435'455u}) {
        seen.max_packet_bytes = limit;
        seen.open = false;
        EXPECT_THAT(problems(check_broker(seen)), ElementsAre(HasSubstr("up to 2097152"))) << limit;
        EXPECT_TRUE(has_problem(check_broker(seen))) << limit;
        EXPECT_THAT(check_broker(seen)[1].advice, HasSubstr("max_packet_size 262144"));
        seen.open = true;
        seen.loopback = true;
        EXPECT_FALSE(has_problem(check_broker(seen))) << "whoever reaches it may do worse";
    }
    for (const std::size_t limit : {300u, 1u << 20, (2u << 20) - 200'000u}) {
        seen.open = false;
        seen.max_packet_bytes = limit;
        EXPECT_THAT(problems(check_broker(seen)), IsEmpty()) << limit;
    }
    seen.max_packet_bytes = 0;
    seen.v5 = false;
    EXPECT_EQ(check_broker(seen).size(), 4U) << "MQTT 3.1.1 knows no limit";
}

TEST(Doctor, OurOwnMessageDoesNotComeBack_PointsAtAccessRules) {
    auto seen = healthy();
    seen.acknowledged.reset();
    EXPECT_THAT(check_broker(seen).back().advice, HasSubstr("asip/reply"));
}

TEST(Doctor, RegistryMissingOrSilent_IsReported) {
    auto seen = healthy();
    seen.registry.clear();
    EXPECT_EQ(check_registry(seen)[0].level, Level::kNote);
    seen.registries = {"r1"};
    EXPECT_EQ(check_registry(seen)[0].level, Level::kProblem);
}

TEST(Doctor, RegistryThatCannotKeep_SaysWhatAndWhy) {
    auto seen = healthy();
    seen.registries = {"r1", "r2", "r3"};
    seen.retained.push_back({"asip/registry/r1/$stats", R"({"values_fault":"the disk is full"})"});
    seen.retained.push_back({"asip/registry/r2/$stats", R"({"history_fault":7,"values_lost":1})"});
    seen.retained.push_back({"asip/registry/r3/$stats", "[]"});
    EXPECT_THAT(problems(check_registry(seen)),
                ElementsAre("registry r1 cannot keep values: the disk is full"));
}

TEST(Doctor, NoBoardWhereAgentsStartByThemselves_IsToBePluggedIn) {
    Observations seen;
    const auto advice = [&seen] { return check_boards(seen).at(0).advice; };
    seen.loopback = true;
    EXPECT_THAT(advice(), StartsWith("start an agent: asip-agent --serial"));
    seen.machine.starts_agents = true;
    EXPECT_THAT(advice(), StartsWith("plug one in, or start an agent for one that is elsewhere"));
    seen.loopback = false;
    EXPECT_THAT(advice(), StartsWith("start an agent")) << "what is plugged in here may go to another bus";
}

TEST(Doctor, OnlineBoardNobodyAnswersFor_AndAgentWithoutBoard_AreDistinguished) {
    auto seen = healthy();
    seen.pings["uno1"].reply.reset();
    EXPECT_THAT(problems(check_boards(seen)), ElementsAre(HasSubstr("nothing answers")));
    seen.pings["uno1"].reply = bus::Reply::refused("board-not-there", "unplugged");
    EXPECT_THAT(problems(check_boards(seen)), ElementsAre(HasSubstr("board-not-there")));
    seen.pings["uno1"].reply = bus::Reply::timeout();
    EXPECT_THAT(problems(check_boards(seen)), ElementsAre(HasSubstr("the board does not")));
}

TEST(Doctor, RetainedStateAgainstLease_IsReported) {
    auto seen = healthy();
    seen.retained.pop_back();
    EXPECT_THAT(problems(check_states(seen)), ElementsAre(HasSubstr("description has expired")));
    seen = healthy();
    seen.boards[0].state = "lost";
    EXPECT_THAT(problems(check_states(seen)), ElementsAre(HasSubstr("its lease ran out")));
    seen = healthy();
    seen.retained[0].payload = "lost";
    EXPECT_THAT(problems(check_states(seen)), ElementsAre(HasSubstr("late will")));
}

TEST(Doctor, BoardThatRefusesThePing_IsNotSaidToBeThere) {
    auto seen = healthy();
    seen.retained[0].payload = "lost";
    seen.pings["uno1"].reply = bus::Reply::refused("board-not-there", "no board");
    EXPECT_THAT(problems(check_states(seen)), IsEmpty());
    seen.pings["uno1"].reply.reset();
    EXPECT_THAT(problems(check_states(seen)), IsEmpty());
}

TEST(Doctor, LostBoard_IsNamedWithItsReasonItsTimeAndWhatToDo) {
    auto seen = healthy();
    seen.retained[0].payload = "lost";
    seen.pings.clear();
    seen.boards[0].state = "lost";
    seen.boards[0].reason = "unplugged";
    seen.boards[0].state_age = 180;
    const auto findings = check_states(seen);
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].what, "uno1 is lost 3 min ago: cable unplugged");
    EXPECT_THAT(findings[0].advice, HasSubstr("plug it in"));
}

TEST(Doctor, BoardThatSpeaksNoAsip_IsNamedByItsUsbPortAndWhatLoadsIt) {
    auto seen = healthy();
    seen.retained[0].payload = "lost";
    seen.pings.clear();
    auto& board = seen.boards[0];
    board.state = "lost";
    board.reason = "silent";
    board.chip.clear();
    board.services.clear();
    board.link = "serial /dev/serial/by-path/pci-0000:00:14.0-usb-0:1.3:1.0-port0";
    const auto findings = check_states(seen);
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].what, "a board at USB port 1.3 that speaks no ASIP (uno1)");
    EXPECT_THAT(findings[0].advice, HasSubstr("asipctl flash uno1"));
    for (const auto* path : {"/dev/ttyUSB0", "/dev/serial/by-id/usb-x-if00", "-usb-", "/x-usb-0:1", ""})
        EXPECT_EQ(port_text(path), path);
}

TEST(Doctor, RetainedCommandsAndInvalidNames_AreReported) {
    auto seen = healthy();
    seen.retained.push_back({"asip/uno1/servo/in", "W,0,90"});
    seen.retained.push_back({"asip/servicebus/a b/$state", "online"});
    EXPECT_THAT(problems(check_retained(seen)), ElementsAre(HasSubstr("asip/uno1/servo/in")));
    EXPECT_THAT(problems(check_names(seen)), ElementsAre(HasSubstr("a b")));
}

TEST(Doctor, TwoAgentsWithOneName_AreReported) {
    auto seen = healthy();
    EXPECT_THAT(check_conflicts(seen), IsEmpty());
    seen.sessions["uno1"] = {"5f3a9c01", "00000001"};
    EXPECT_THAT(problems(check_conflicts(seen)), ElementsAre(HasSubstr("two agents")));
    seen.sessions.clear();
    seen.boards[0].conflict = bus::Conflict{"a", "b", "pi2 asip-agent-9"};
    EXPECT_THAT(problems(check_conflicts(seen)), ElementsAre(HasSubstr("pi2")));
}

TEST(Doctor, ClockAwayFromTheRegistrys_IsReported) {
    auto seen = healthy();
    EXPECT_THAT(problems(check_clocks(seen)), IsEmpty());
    seen.asked += 5min;
    seen.answered += 5min;
    EXPECT_THAT(problems(check_clocks(seen)), ElementsAre(HasSubstr("ahead")));
    seen = healthy();
    seen.asked -= 5min;
    seen.answered -= 5min;
    EXPECT_THAT(problems(check_clocks(seen)), ElementsAre(HasSubstr("behind")));
}

TEST(Doctor, BoardThatWeMayNotAsk_IsNotCalledGone) {
    auto seen = healthy();
    seen.pings["uno1"] = {.reply = {}, .denied = true};
    const auto findings = check_boards(seen);
    EXPECT_THAT(problems(findings), ElementsAre(HasSubstr("not asked: uno1; the broker does not let us")));
    EXPECT_FALSE(has_problem(findings));
}

TEST(Doctor, NoRegistryAnswered_NothingIsSaidOfItsClock) {
    for (const bool online : {false, true}) {
        auto seen = healthy();
        seen.registry.clear();
        if (online) seen.registries = {"r1"};
        seen.asked = seen.answered = {};  // nothing was asked
        EXPECT_THAT(check_clocks(seen), IsEmpty());
    }
}

TEST(Doctor, AnswerThatTookLong_IsNoWrongClock) {
    auto seen = healthy();
    seen.answered += 40s;
    EXPECT_THAT(problems(check_clocks(seen)), IsEmpty());
    seen.asked += 20s;
    EXPECT_THAT(problems(check_clocks(seen)), ElementsAre(HasSubstr("ahead")));
}

TEST(Doctor, PortsWithoutRightAndModemManager_AreReported) {
    Machine machine;
    machine.ports = {{"/dev/ttyACM0", false, "dialout"}, {"/dev/ttyUSB0", true, "dialout"}};
    machine.modem_manager = true;
    const auto findings = check_machine(machine);
    EXPECT_THAT(problems(findings), ElementsAre(HasSubstr("/dev/ttyACM0"), HasSubstr("ModemManager")));
    EXPECT_THAT(findings[0].advice, HasSubstr("usermod -aG dialout"));
    machine.udev_rule = true;
    EXPECT_EQ(problems(check_machine(machine)).size(), 1U);
}

TEST(Doctor, BrlttyOnThisMachine_IsNamedWithWhatToDo) {
    Machine machine;
    EXPECT_THAT(check_machine(machine), IsEmpty());
    machine.brltty = true;
    const auto findings = check_machine(machine);
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].level, Level::kNote) << "it may be wanted";
    EXPECT_THAT(findings[0].what, HasSubstr("brltty is installed"));
    EXPECT_THAT(findings[0].advice, HasSubstr("apt remove brltty"));
}

TEST(LookAtMachine, Brltty_IsSeenAsProcessAndAsRuleUnlessThatIsTurnedOff) {
    namespace fs = std::filesystem;
    const auto root = fs::temp_directory_path() / ("asip-brltty-" + std::to_string(::getpid()));
    fs::create_directories(root / "usr/lib/udev/rules.d");
    fs::create_directories(root / "etc/udev/rules.d");
    EXPECT_FALSE(look_at_machine(root).brltty);
    std::ofstream(root / "usr/lib/udev/rules.d/85-brltty.rules") << "# converters\n";
    EXPECT_TRUE(look_at_machine(root).brltty);
    fs::create_symlink("/dev/null", root / "etc/udev/rules.d/85-brltty.rules");
    EXPECT_FALSE(look_at_machine(root).brltty) << "as doctor says";
    fs::create_directories(root / "proc/7");
    std::ofstream(root / "proc/7/comm") << "brltty\n";
    EXPECT_TRUE(look_at_machine(root).brltty);
    fs::remove_all(root);
}

TEST(Doctor, HomeAssistantWithoutAGatewayThatExports_IsReported) {
    Observations seen;
    EXPECT_THAT(check_exports(seen), IsEmpty());
    seen.home_assistant = true;
    ASSERT_EQ(check_exports(seen).size(), 1U);
    EXPECT_THAT(check_exports(seen)[0].advice, HasSubstr("asip-gateway export home-assistant"));
    seen.retained = {{"asip/export/ha/$state", "offline"}, {"asip/export/ha/uno1/$state", "online"}};
    EXPECT_EQ(check_exports(seen)[0].level, Level::kNote);
    seen.retained[0].payload = "online";
    EXPECT_EQ(check_exports(seen)[0].what, "a gateway shows 1 board to Home Assistant");
    EXPECT_EQ(check_exports(seen)[0].level, Level::kFine);
    seen.retained.push_back({"asip/export/dashboard/lab", "{}"});
    seen.retained.push_back({"asip/export/dashboard/hall", R"({"removed":true})"});
    ASSERT_EQ(check_exports(seen).size(), 2U);
    EXPECT_EQ(check_exports(seen)[0].what, "1 dashboard is kept on the bus");
}

TEST(LookAtMachine, FilesOfAMachine_AreRead) {
    namespace fs = std::filesystem;
    const auto root = fs::temp_directory_path() / ("asip-machine-" + std::to_string(::getpid()));
    fs::create_directories(root / "dev");
    fs::create_directories(root / "proc/42");
    fs::create_directories(root / "etc/udev/rules.d");
    std::ofstream(root / "dev/ttyACM0") << "";
    std::ofstream(root / "dev/ttyS0") << "";
    fs::create_directories(root / "proc/41/comm");  // cannot be read, as that of a process that has just
                                                    // ended
    std::ofstream(root / "proc/42/comm") << "ModemManager\n";
    auto machine = look_at_machine(root);
    ASSERT_EQ(machine.ports.size(), 1U);
    EXPECT_TRUE(machine.ports[0].may_use);
    EXPECT_TRUE(machine.modem_manager);
    EXPECT_FALSE(machine.udev_rule);
    std::ofstream(root / "etc/udev/rules.d/70-asip.rules") << "ENV{ID_MM_DEVICE_IGNORE}=\"1\"\n";
    machine = look_at_machine(root);
    EXPECT_TRUE(machine.udev_rule);
    EXPECT_FALSE(machine.starts_agents);
    fs::create_directories(root / "usr/lib/systemd/system");
    std::ofstream(root / "usr/lib/systemd/system/asip-agent@.service") << "";
    EXPECT_TRUE(look_at_machine(root).starts_agents);
    fs::remove_all(root);
    machine = look_at_machine(root);
    EXPECT_THAT(machine.ports, IsEmpty());
    EXPECT_FALSE(machine.modem_manager);
}

}  // namespace
}  // namespace asip::cli
