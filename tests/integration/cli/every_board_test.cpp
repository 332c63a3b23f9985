// SPDX-License-Identifier: Apache-2.0
// Every verb that reads, follows or commands a board, on each kind of board: with our firmware, and with that
// of ASIP 0.4.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

struct BoardKind {
    const char* name;
    const char* image;
    friend std::ostream& operator<<(std::ostream& out, const BoardKind& kind) { return out << kind.name; }
};

class EveryBoardTest : public BusTest, public ::testing::WithParamInterface<BoardKind> {
  protected:
    void SetUp() override {
        ASSERT_TRUE(probe_.wait_for("asip/registry/r1/$state", "online")) << registry_.errors();
        const auto file = folder_.write(
            "desk.json", std::string(R"({"name":"desk","board":"uno","image":")") + ASIP_IMAGES + "/" +
                             GetParam().image + R"(","link":")" + folder_.file("port") +
                             R"(","parts":[{"kind":"ultrasonic","name":"distance","trigger":7,"echo":7,)"
                             R"("distance":42},{"kind":"servo","name":"servo","pin":9}]})");
        sim_ = std::make_unique<ChildProcess>(
            Words{ASIP_PROGRAMS "/asip-sim", "--socket", folder_.file("sim.sock"), file});
        ASSERT_TRUE(sim_->wait_for_output("desk .*port")) << sim_->errors();
        agent_ = std::make_unique<ChildProcess>(
            Words{ASIP_PROGRAMS "/asip-agent", "--serial", folder_.file("port"), "--name", "desk"},
            environment());
        ASSERT_EQ(asipctl({"wait", "desk", "--for", "online", "--timeout", "60s"}).status, 0)
            << agent_->errors();
        ASSERT_EQ(asipctl({"send", "desk/distance", "report", "100"}).status, 0);
    }

    void fail_once() const { asipctl({"send", "desk/servo", "write", "9", "90"}); }
    /// What the verb prints as JSON; it must succeed.
    Json json(Words arguments) const {
        arguments.insert(arguments.end(), {"-o", "jsonl", "--timeout", "20s"});
        const auto result = asipctl(arguments);
        EXPECT_EQ(result.status, 0) << arguments.front() << ": " << result.errors;
        const auto line = result.output.substr(0, result.output.find('\n'));
        EXPECT_TRUE(Json::accept(line)) << arguments.front() << ": " << line;
        return Json::parse(line, nullptr, false);
    }
    void commanded(Words arguments) const {
        arguments.insert(arguments.end(), {"-o", "jsonl", "--timeout", "20s"});
        const auto result = asipctl(arguments);
        EXPECT_EQ(result.status, 0) << arguments.front() << ": " << result.errors;
        const auto first = result.output.substr(0, result.output.find('\n'));
        EXPECT_TRUE(first.empty() || Json::accept(first)) << arguments.front() << ": " << first;
    }

    TempDir folder_;
    ChildProcess registry_{
        {ASIP_PROGRAMS "/asip-registry", "--id", "r1", "--history", folder_.file("history.db")},
        environment()};
    std::unique_ptr<ChildProcess> sim_, agent_;
};

INSTANTIATE_TEST_SUITE_P(Kind, EveryBoardTest,
                         ::testing::Values(BoardKind{"Ours", "asip_uno_services.elf"},
                                           BoardKind{"Asip04", "asip_uno_04_services.elf"}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(EveryBoardTest, IsReadAndFollowed) {
    EXPECT_EQ(json({"get", "desk/distance/0"})["value"], 42);
    EXPECT_EQ(json({"subscribe", "desk/distance", "-n", "1", "--field", "0", "--changes", "--max-hz",
                    "5"})["value"],
              42);
    EXPECT_EQ(json({"wait", "desk", "--for", "online"})["state"], "online");
    EXPECT_EQ(json({"list", "--kind", "distance", "--sort", "chip"})["board"], "desk");
    EXPECT_EQ(json({"list", "services", "--unit", "cm"})["name"], "distance");
    EXPECT_EQ(json({"show", "desk/distance"})["board"], "desk");
    EXPECT_EQ(json({"events", "desk", "--last", "20"})["board"], "desk");
    EXPECT_EQ(json({"events", "desk", "--since", "1h", "-n", "1"})["board"], "desk");
    const auto line = asipctl({"subscribe", "desk/distance", "-n", "1", "--format", "{data.distance.0}"});
    EXPECT_EQ(line.output, "42\n") << line.errors;
    const auto wide = asipctl({"list", "-o", "wide"});
    EXPECT_THAT(wide.output, HasSubstr("serial"));
}

TEST_P(EveryBoardTest, ItsErrorsAreLogged) {
    ChildProcess logs(program({"events", "--logs", "desk", "-n", "1", "-W", "20s", "-o", "jsonl"}),
                      environment());
    EXPECT_TRUE(wait_until([&] {
        fail_once();
        return !logs.running();
    }));
    EXPECT_EQ(logs.wait_exit(), 0);
    EXPECT_THAT(logs.output(), HasSubstr("INVALID_DEVICE_NUMBER"));
}

TEST_P(EveryBoardTest, IsCommanded) {
    commanded({"send", "desk/servo", "write", "0", "90"});
    commanded({"pin", "desk", "13", "high"});
    commanded({"stop", "desk", "--once"});
    commanded({"send", "desk/io", "pwm", "3", "120", "--hold", "5s", "--for", "300ms"});
    const auto ping = asipctl({"ping", "desk", "-c", "1", "-o", "json"});
    EXPECT_EQ(ping.status, 0) << ping.errors;
    commanded({"release", "desk", "--for", "10s"});
    EXPECT_EQ(json({"release", "desk", "--back"})["same"], true);
    commanded({"label", "desk", "room=lab"});
}

TEST_P(EveryBoardTest, IsFlashed) {
    const auto flashed = asipctl(
        {"flash", "desk", ASIP_IMAGES "/asip_uno.elf", "--socket", folder_.file("sim.sock"), "-o", "json"});
    const auto record = Json::parse(flashed.output, nullptr, false);
    ASSERT_TRUE(record.is_object()) << flashed.output << flashed.errors;
    EXPECT_EQ(flashed.status, 0) << flashed.errors;
    EXPECT_EQ(record["sketch"], "AsipHello");
}

TEST_P(EveryBoardTest, FailureOfPinAndRelease_IsARecordToo) {
    const auto failed = [this](Words words) {
        words.insert(words.end(), {"-o", "json"});
        const auto result = asipctl(words);
        EXPECT_NE(result.status, 0) << words.front();
        auto record = Json::parse(result.output, nullptr, false);
        EXPECT_EQ(record.value("board", ""), words[1]) << result.output << result.errors;
        EXPECT_FALSE(record.value("error", "").empty());
        return record;
    };
    const auto pin = failed({"pin", "desk", "9", "high"});
    EXPECT_EQ(pin["status"], "error") << pin;
    EXPECT_EQ(failed({"pin", "desk", "200", "high"})["status"], "refused");
    EXPECT_EQ(failed({"release", "nobody"})["status"], "timeout");
    EXPECT_EQ(asipctl({"release", "desk", "--for", "2h"}).status, 2);
    EXPECT_EQ(json({"release", "desk", "--for", "10s"})["state"], "updating");
    EXPECT_EQ(failed({"release", "desk"})["reason"], "released");
    EXPECT_EQ(failed({"pin", "desk", "13"})["status"], "refused");
    EXPECT_EQ(json({"release", "desk", "--back"})["same"], true);
}

}  // namespace
}  // namespace asip::test
