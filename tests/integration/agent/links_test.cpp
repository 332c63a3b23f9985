// SPDX-License-Identifier: Apache-2.0
// A button on one board switches a lamp on another: real broker, agents, asipctl and firmware.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/integration/agent/rig.hpp"
#include "tests/support/tcp_relay.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// An Uno with one part.
class Board {
  public:
    Board(const std::string& name, const std::string& part, const std::string& image = "asip_uno")
        : name_(name), port_(folder_.file(name)) {
        const auto file = folder_.write(
            name + ".json", R"({"name":")" + name + R"(","board":"uno","image":")" ASIP_IMAGES "/" + image +
                                R"(.elf","link":")" + port_ + R"(","parts":[)" + part + "]}");
        process_ = std::make_unique<ChildProcess>(
            std::vector<std::string>{ASIP_PROGRAMS "/asip-sim", file, "--no-socket"});
        if (!process_->wait_for_output(" port ")) throw std::runtime_error(process_->errors());
    }
    const std::string& port() const { return port_; }
    void command(const std::string& line) { process_->write_input(line + "\n"); }
    /// Each change of the part, in order.
    std::vector<std::string> changes() const {
        std::vector<std::string> result;
        std::istringstream lines(process_->output());
        for (std::string line; std::getline(lines, line);)
            if (const auto at = line.find(" part "); line.starts_with(name_ + " ") && at != std::string::npos)
                result.push_back(line.substr(at + 6));
        return result;
    }

  private:
    TempDir folder_;
    std::string name_, port_;
    std::unique_ptr<ChildProcess> process_;
};

class Links : public testing::Test {
  protected:
    std::unique_ptr<ChildProcess> start(const std::string& board, const std::string& port,
                                        const std::string& by = {}) {
        auto agent = std::make_unique<ChildProcess>(std::vector<std::string>{
            ASIP_PROGRAMS "/asip-agent", "--serial", port, "--broker", by.empty() ? broker.url() : by,
            "--name", board, "--lease", "3", "--state-dir", state.file("state")});
        EXPECT_TRUE(wait_state(probe, "online", kDeadline, board)) << agent->errors();
        return agent;
    }
    Finished asipctl(std::vector<std::string> words) {
        words.insert(words.begin(), {ASIP_PROGRAMS "/asipctl", "--broker", broker.address()});
        return run(std::move(words));
    }
    void wire_up() {
        for (const std::vector<std::string>& words :
             {std::vector<std::string>{"label", "desk/io/2", "class=button"},
              {"pin", "desk", "2", "pullup"},
              {"send", "lamp/io", "mode", "13", "output"}}) {
            const auto done = asipctl(words);
            ASSERT_EQ(done.status, 0) << done.errors;
        }
    }
    testing::AssertionResult is(bool on) {
        const std::string wanted = on ? "on" : "off";
        if (wait_until([&] {
                const auto seen = lamp.changes();
                return !seen.empty() && seen.back() == wanted;
            }))
            return testing::AssertionSuccess();
        return testing::AssertionFailure()
               << "not " << wanted << ": " << probe.last("asip/lamp/$links").value_or("none");
    }
    void press() {
        desk.command("press part");
        ASSERT_TRUE(wait_until(
            [&] { return probe.last("asip/desk/$values")->find("\"press\"") != std::string::npos; }));
        desk.command("release part");
    }
    /// The link hears its source.
    bool heard() {
        return wait_until([&] {
            const auto links = probe.last("asip/lamp/$links");
            return links && links->find("\"name\"") != std::string::npos &&
                   links->find("fault") == std::string::npos;
        });
    }

    MosquittoBroker broker{{.persistence = true}};
    BusProbe probe{broker.port(), {"asip/#"}};
    TempDir state;
    Board desk{"desk", R"({"kind":"button","name":"part","pin":2})"};
    Board lamp{"lamp", R"({"kind":"led","name":"part","pin":13})"};
};

TEST_F(Links, ButtonSwitchesALampOfAnotherAgent_AndNoRestartDoes) {
    const ChildProcess registry(
        {ASIP_PROGRAMS "/asip-registry", "--broker", broker.url(), "--history", state.file("history.db")});
    auto of_desk = start("desk", desk.port());
    auto of_lamp = start("lamp", lamp.port());
    wire_up();
    const auto made = asipctl({"link", "desk/io/2", "lamp/io/13", "--toggle"});
    ASSERT_EQ(made.status, 0) << made.errors;
    EXPECT_THAT(made.output, HasSubstr("each press of desk/io/2 switches io/13"));
    ASSERT_TRUE(heard());
    press();
    ASSERT_TRUE(is(true));
    const auto note = probe.wait_for([](const mqtt::Message& message) {
        return message.topic == "asip/servicebus/lamp/$commands" &&
               message.payload.find("by") != std::string::npos &&
               message.payload.find("link desk-io-2-io-13, because desk/io/2 had a press") !=
                   std::string::npos;
    });
    EXPECT_TRUE(note);
    EXPECT_TRUE(wait_until([&] {
        return asipctl({"events", "lamp", "--last", "20"})
                   .output.find(", by link desk-io-2-io-13, because desk/io/2 had a press") !=
               std::string::npos;
    })) << "the history";

    const auto changes = lamp.changes().size();
    const auto back = [&](const std::string& board) {
        ASSERT_TRUE(
            wait_until([&] { return probe.last("asip/servicebus/" + board + "/$state") == "online"; }));
        ASSERT_TRUE(heard());
    };
    of_lamp->signal(SIGKILL);
    of_lamp->wait_exit();
    ASSERT_TRUE(wait_state(probe, "lost", kDeadline, "lamp"));
    probe.clear();
    of_lamp = start("lamp", lamp.port());
    back("lamp");
    of_desk->signal(SIGKILL);
    of_desk->wait_exit();
    ASSERT_TRUE(wait_state(probe, "lost", kDeadline, "desk"));
    of_desk = start("desk", desk.port());
    probe.clear();
    broker.restart();
    back("lamp");
    back("desk");
    EXPECT_EQ(lamp.changes().size(), changes) << "a restart switched it";

    ASSERT_TRUE(wait_until([&] { return probe.last("asip/desk/$values").has_value(); }));
    press();
    EXPECT_TRUE(is(false));
    // It is shown at most twice a second.
    EXPECT_TRUE(wait_until([&] {
        return asipctl({"link", "list"}).output.find("because desk/io/2 had a press") != std::string::npos;
    }));
    const auto refused = asipctl({"link", "desk/io/2", "lamp/io/14", "--toggle"});
    EXPECT_NE(refused.status, 0);
    EXPECT_THAT(refused.errors, HasSubstr("there is no property io/14"));
    const auto circle = asipctl({"link", "lamp/io/13", "lamp/io/13", "--inverted"});
    EXPECT_THAT(circle.errors, HasSubstr("circle: lamp/io/13, lamp/io/13"));
    EXPECT_THAT(asipctl({"link", "lamp/io/13", "desk/io/2"}).errors,
                HasSubstr("circle: lamp/io/13, desk/io/2, lamp/io/13"))
        << "over two agents";
    EXPECT_EQ(asipctl({"link", "remove", "desk-io-2-io-13"}).status, 0);
    press();
    EXPECT_EQ(lamp.changes().size(), changes + 1);
}

TEST_F(Links, WhatWaitsOfASource_DelaysNoCommand) {
    TcpRelay way(broker.port());
    const auto of_desk = start("desk", desk.port());
    const auto of_lamp = start("lamp", lamp.port(), "mqtt://127.0.0.1:" + std::to_string(way.port()));
    wire_up();
    ASSERT_EQ(asipctl({"link", "desk/io/2", "lamp/io/13", "--toggle"}).status, 0);
    ASSERT_TRUE(heard());
    way.cut([](std::string_view first) { return first.find("-sources") != std::string_view::npos; });
    ASSERT_NO_FATAL_FAILURE(press());
    // Over the same connection the press would come before these.
    EXPECT_EQ(asipctl({"send", "lamp/io", "write", "13", "1"}).status, 0);
    EXPECT_EQ(asipctl({"send", "lamp/io", "write", "13", "0"}).status, 0);
    ASSERT_TRUE(is(false));
    way.restore();
    EXPECT_TRUE(is(true)) << "the press";
}

TEST_F(Links, TwoBoardsOfOneAgent_NeedNoBroker) {
    std::ofstream(state.file("boards.conf"))
        << "broker = " << broker.url() << "\nstate-dir = " << state.file("state")
        << "\n[board desk]\nserial = " << desk.port() << "\n[board lamp]\nserial = " << lamp.port() << "\n";
    ChildProcess agent({ASIP_PROGRAMS "/asip-agent", "--config", state.file("boards.conf")});
    for (const auto* board : {"desk", "lamp"})
        ASSERT_TRUE(wait_state(probe, "online", kDeadline, board)) << agent.errors();
    wire_up();
    const auto made = asipctl({"link", "desk/io/2", "lamp/io/13", "--toggle"});
    ASSERT_EQ(made.status, 0) << made.errors;
    ASSERT_TRUE(heard());
    broker.stop();
    desk.command("press part");
    EXPECT_TRUE(is(true));
    desk.command("release part");
}

TEST_F(Links, SensorOfTheSameAgent_IsDemandedForItsOwnBoardAndForANeighbour) {
    Board near("near",
               R"({"kind":"ultrasonic","name":"sonar","pin":7,"distance":20},)"
               R"({"kind":"led","name":"part","pin":13})",
               "asip_uno_services");
    std::ofstream(state.file("boards.conf"))
        << "broker = " << broker.url() << "\nstate-dir = " << state.file("state")
        << "\nreports = on-demand\n[board near]\nserial = " << near.port()
        << "\n[board lamp]\nserial = " << lamp.port() << "\n";
    ChildProcess agent({ASIP_PROGRAMS "/asip-agent", "--config", state.file("boards.conf")});
    for (const auto* board : {"near", "lamp"}) {
        ASSERT_TRUE(wait_state(probe, "online", kDeadline, board)) << agent.errors();
        ASSERT_EQ(asipctl({"send", std::string(board) + "/io", "mode", "13", "output"}).status, 0);
    }
    const auto own = asipctl({"link", "near/distance/0", "near/io/13", "--above", "50"});
    ASSERT_EQ(own.status, 0) << own.errors;
    near.command("set sonar 80");
    EXPECT_TRUE(wait_until([&] { return !near.changes().empty() && near.changes().back() == "on"; }));
    ASSERT_EQ(asipctl({"link", "remove", "near/near-distance-0-io-13"}).status, 0);
    const auto neighbour = asipctl({"link", "near/distance/0", "lamp/io/13", "--below", "50"});
    ASSERT_EQ(neighbour.status, 0) << neighbour.errors;
    near.command("set sonar 20");
    EXPECT_TRUE(is(true));
}

TEST_F(Links, DamagedFile_IsPutAsideAndNamed) {
    const auto folder = std::filesystem::path(state.file("state")) / "links" / "lamp";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "bad.json") << "{\"name\":";
    std::ofstream(folder / "good.json")
        << R"({"name":"good","from":"desk/io/2","to":"io/13","when":"toggles"})";
    auto of_lamp = start("lamp", lamp.port());
    const auto shown = probe.wait_for("asip/lamp/$links");
    ASSERT_TRUE(shown);
    EXPECT_EQ(json::parse(shown->payload)["set_aside"], json({"bad.json.damaged"})) << "no path";
    EXPECT_THAT(shown->payload, HasSubstr("\"good\""));
    EXPECT_TRUE(of_lamp->wait_for_errors("bad.json"));
    EXPECT_TRUE(std::filesystem::exists(folder / "bad.json.damaged"));
}

}  // namespace
}  // namespace asip::test
