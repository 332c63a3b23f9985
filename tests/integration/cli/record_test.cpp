// SPDX-License-Identifier: Apache-2.0
// Recordings: made of a real board, of a flood, cut by kill -9; and played as boards of their own.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class RecordTest : public BusTest {
  protected:
    std::vector<nlohmann::json> lines(const std::string& path) const {
        std::ifstream file(path);
        std::vector<nlohmann::json> result;
        for (std::string line; std::getline(file, line) && !file.eof();)
            result.push_back(nlohmann::json::parse(line));
        return result;
    }

    std::size_t values(const std::string& path) const {
        const auto all = lines(path);
        return static_cast<std::size_t>(
            std::ranges::count_if(all, [](const auto& line) { return line.value("what", "") == "value"; }));
    }

    void say(int value) {
        probe_.publish("asip/uno1/distance/out", R"({"distance":[)" + std::to_string(value) + "]}", false, 0);
    }

    /// A recording of uno1: announced, ten values, lost.
    std::string walk() {
        const auto path = folder_.file("walk.jsonl");
        announce("uno1");
        ChildProcess record(program({"record", path}), environment());
        EXPECT_TRUE(wait_until([&] {
            say(0);
            return values(path) > 0;
        })) << record.errors();
        for (int i = 1; i <= 10; ++i)
            say(i);
        probe_.publish("asip/uno1/servo/in", "W,0,90");
        announce("uno1", "lost");
        EXPECT_TRUE(wait_until([&] {
            const auto all = lines(path);
            return all.back().value("what", "") == "state" && all.back()["text"] == "lost";
        }));
        record.signal(SIGINT);
        EXPECT_EQ(record.wait_exit(), 0);
        return path;
    }

    /// As if the board had never been there.
    void clear() {
        for (const auto* topic : {"asip/servicebus/uno1/$description", "asip/servicebus/uno1/$state"})
            probe_.publish(topic, "", true);
        ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
        probe_.clear();
    }

    TempDir folder_;
};

TEST_F(RecordTest, WhatBoardsSayAndAreAsked_IsRecordedWithTimes) {
    const auto path = walk();
    const auto all = lines(path);
    EXPECT_EQ(all.front()["asip"], "recording");
    std::map<std::string, int> kinds;
    double last = 0;
    for (std::size_t i = 1; i < all.size(); ++i) {
        ++kinds[all[i]["what"]];
        EXPECT_GE(all[i]["at"], last);
        last = all[i]["at"];
    }
    EXPECT_GE(kinds["value"], 11);
    EXPECT_EQ(kinds["command"], 1);
    EXPECT_GE(kinds["description"], 1);
    const auto again = asipctl({"record", path, "-n", "1"});
    EXPECT_EQ(again.status, 1);
    EXPECT_THAT(again.errors, HasSubstr("--replace"));
    EXPECT_EQ(lines(path), all) << "what was there is not touched";
}

TEST_F(RecordTest, OneService_IsRecordedWithoutTheOthers) {
    announce("uno1");
    const auto path = folder_.file("one.jsonl");
    ChildProcess record(program({"record", path, "uno1/distance", "-o", "json", "-n", "4"}), environment());
    ASSERT_TRUE(wait_until([&] {
        probe_.publish("asip/uno1/servo/out", "{}");
        probe_.publish("asip/uno1/out", "@D,e,1,{1}");
        say(1);
        return !record.running();
    }));
    EXPECT_EQ(record.wait_exit(), 0);  // all of its output is read
    EXPECT_EQ(nlohmann::json::parse(record.output())["boards"], 1);
    for (const auto& line : lines(path))
        EXPECT_THAT(line.dump(), Not(testing::AnyOf(HasSubstr("servo\"}"), HasSubstr("\"line\""))));
    EXPECT_EQ(values(path), 2U);
}

TEST_F(RecordTest, Killed_LosesAtMostTheLastSecond) {
    announce("uno1");
    const auto path = folder_.file("killed.jsonl");
    ChildProcess record(program({"record", path}), environment());
    ASSERT_TRUE(wait_until([&] {
        say(0);
        return values(path) > 0;
    }));
    const auto before = values(path);
    for (int i = 0; i < 1000; ++i)
        say(i);
    // A second later all is there, whatever then happens to the program.
    std::this_thread::sleep_for(time_limit(1s));
    record.signal(SIGKILL);
    record.wait_exit();
    EXPECT_GE(values(path), before + 1000);
    const auto played = asipctl({"replay", path, "--speed", "1000", "--prefix", "old-", "-o", "json"});
    EXPECT_EQ(played.status, 0) << played.errors;
}

TEST_F(RecordTest, RegistryKilled_RecordingGoesOnAndCanBePlayed) {
    announce("uno1");
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--id", "r1"}, environment());
    ASSERT_TRUE(probe_.wait_for("asip/registry/r1/$state", "online"));
    const auto path = folder_.file("orphan.jsonl");
    ChildProcess record(program({"record", path}), environment());
    ASSERT_TRUE(wait_until([&] {
        say(0);
        return values(path) > 0;
    }));
    registry.signal(SIGKILL);
    ASSERT_TRUE(probe_.wait_for("asip/registry/r1/$state", "lost"));
    const auto before = values(path);
    EXPECT_TRUE(wait_until([&] {
        say(1);
        return values(path) > before + 2;
    })) << record.errors();
    record.signal(SIGINT);
    EXPECT_EQ(record.wait_exit(), 0);
    EXPECT_EQ(record.errors(), "") << "a recording needs no registry";
    const auto played = asipctl({"replay", path, "--speed", "1000", "--prefix", "old-", "-o", "json"});
    EXPECT_EQ(played.status, 0) << played.errors;
}

TEST_F(RecordTest, Dash_WritesTheLinesToStandardOutput) {
    announce("uno1");
    ChildProcess record(program({"record", "-", "uno1", "-n", "5"}), environment());
    ASSERT_TRUE(wait_until([&] {
        say(7);
        return !record.running();
    }));
    EXPECT_EQ(record.wait_exit(), 0) << record.errors();
    EXPECT_THAT(record.errors(), HasSubstr("asipctl: 5 messages of 1 board"));
    const auto all = lines(folder_.write("dash.jsonl", record.output()));
    EXPECT_EQ(all.size(), 6u) << record.output();
    EXPECT_EQ(all.front()["asip"], "recording");
    EXPECT_FALSE(std::filesystem::exists("-"));
    const auto both = asipctl({"record", "-", "-o", "json"});
    EXPECT_EQ(both.status, 2);
    EXPECT_THAT(both.errors, HasSubstr("leave -o"));
}

TEST_F(RecordTest, DashIntoAPipeThatCloses_EndsWithoutAnError) {
    announce("uno1");
    const auto first =
        run({"sh", "-c",
             std::string("{ " ASIP_PROGRAMS "/asipctl record - 2>&1; echo status $? >&2; } | head -1")},
            environment());
    EXPECT_THAT(first.output, HasSubstr(R"("asip":"recording")"));
    EXPECT_THAT(first.errors, HasSubstr("status 0"));
}

TEST_F(RecordTest, NoBroker_LeavesWhatWasThere) {
    const auto kept = folder_.write("kept.jsonl", "a recording\n");
    const auto made = folder_.file("made.jsonl");
    const auto away = [](const std::string& path) {
        return run(program({"record", path, "--replace", "--broker", "127.0.0.1:1"}));
    };
    EXPECT_EQ(away(kept).status, 3);
    EXPECT_EQ(away(made).status, 3);
    std::ifstream file(kept);
    std::string text;
    std::getline(file, text);
    EXPECT_EQ(text, "a recording");
    EXPECT_FALSE(std::filesystem::exists(made));
}

TEST_F(RecordTest, Replace_LeavesNothingOfALongerRecording) {
    announce("uno1");
    const auto path = folder_.write("long.jsonl", std::string(100'000, 'x'));
    EXPECT_EQ(asipctl({"record", path, "--replace", "-n", "1"}).status, 0);
    EXPECT_EQ(lines(path).size(), 2u);
}

TEST_F(RecordTest, FullDisk_EndsTheRecordingWithAFailure) {
    announce("uno1");
    const auto record = asipctl({"record", "/dev/full", "--replace", "-W", "10s"});
    EXPECT_EQ(record.status, 1);
    EXPECT_THAT(record.errors, HasSubstr("cannot be written"));
}

TEST_F(RecordTest, Replayed_BoardIsAMemberOfTheBus) {
    const auto path = walk();
    clear();
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--id", "r1"}, environment());
    ASSERT_TRUE(probe_.wait_for("asip/registry/r1/$state", "online"));
    ChildProcess replay(program({"replay", path, "--speed", "0.5", "--loop"}), environment());
    ASSERT_TRUE(replay.wait_for_errors("replaying 1 board")) << replay.errors();
    EXPECT_TRUE(
        wait_until([&] { return asipctl({"list", "--state", "online", "-o", "name"}).output == "uno1\n"; }));
    EXPECT_THAT(asipctl({"show", "uno1"}).output, HasSubstr("replay walk.jsonl"));
    // As recorded, it is lost now and then: then no board is asked.
    EXPECT_TRUE(wait_until([&] {
        const auto got = asipctl({"get", "uno1/distance", "--timeout", "20s"});
        return got.status == 0 && got.output.find(" cm") != std::string::npos;
    }));
    EXPECT_TRUE(wait_until([&] {
        const auto sent = asipctl({"send", "uno1/servo", "write", "0", "90", "-o", "json"});
        return sent.status == 1 && sent.output.find(R"("recorded")") != std::string::npos;
    }));
    EXPECT_TRUE(wait_until([&] { return probe_.last("asip/servicebus/uno1/$state") == "lost"; }))
        << "as recorded";
    const auto second = asipctl({"replay", path});
    EXPECT_EQ(second.status, 1);
    EXPECT_THAT(second.errors, HasSubstr("is held by"));
    EXPECT_THAT(second.errors, HasSubstr("--prefix"));
    replay.signal(SIGINT);
    EXPECT_EQ(replay.wait_exit(), 0);
    EXPECT_TRUE(probe_.wait_for("asip/servicebus/uno1/$state", "offline"));
}

TEST_F(RecordTest, ReplayOfValuesAlone_ListsTheBoardAndItsServices) {
    const auto path = folder_.write(
        "values.jsonl",
        R"({"asip":"recording","version":1,"began":"2026-11-21T10:00:00.000Z"})"
        "\n"
        R"({"at":0.001,"what":"value","board":"esp","service":"distance","data":{"distance":[1]}})"
        "\n");
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--id", "r1"}, environment());
    ASSERT_TRUE(probe_.wait_for("asip/registry/r1/$state", "online"));
    ChildProcess replay(program({"replay", path, "--loop", "--speed", "0.01"}), environment());
    EXPECT_TRUE(wait_until([&] {
        return asipctl({"list", "services", "-o", "name"}).output == "esp/distance\n";
    })) << replay.errors();
    replay.signal(SIGINT);
    EXPECT_EQ(replay.wait_exit(), 0);
}

TEST_F(RecordTest, ReplayKilled_LeavesALostBoard) {
    const auto path = walk();
    clear();
    ChildProcess replay(program({"replay", path, "--speed", "0.01"}), environment());
    ASSERT_TRUE(replay.wait_for_errors("replaying 1 board")) << replay.errors();
    ASSERT_TRUE(probe_.wait_for("asip/servicebus/uno1/$state", "online"));
    probe_.clear();
    replay.signal(SIGKILL);
    EXPECT_TRUE(probe_.wait_for("asip/servicebus/uno1/$state", "lost"));
}

TEST_F(RecordTest, ReplayAtFullSpeed_LosesNothing) {
    const auto path = folder_.file("many.jsonl");
    const int messages = other_programs() ? 4'000 : 20'000;  // sanitized, ten times slower
    {
        std::ofstream file(path);
        file << R"({"asip":"recording","version":1,"began":"2026-11-21T10:00:00.000Z"})" << '\n';
        for (int i = 0; i < messages; ++i)
            file << R"({"at":0,"what":"value","board":"esp","service":"x","data":{"n":)" << i << "}}\n";
    }
    BusProbe probe(broker_.port(), {"asip/esp/x/out"});
    const auto replay = asipctl({"replay", path, "-o", "json"});
    ASSERT_EQ(replay.status, 0) << replay.errors;
    EXPECT_EQ(nlohmann::json::parse(replay.output)["messages"], messages);
    EXPECT_TRUE(wait_until([&] {
        return probe.count("asip/esp/x/out") == static_cast<std::size_t>(messages);
    })) << probe.count("asip/esp/x/out");
    EXPECT_EQ(probe.messages().back().payload, "{\"n\":" + std::to_string(messages - 1) + "}");
}

TEST_F(RecordTest, WhatIsNoRecording_IsRefused) {
    const auto path = folder_.write("notes.txt", "hello\n");
    const auto replay = asipctl({"replay", path});
    EXPECT_EQ(replay.status, 1);
    EXPECT_THAT(replay.errors, HasSubstr("asipctl record"));
    EXPECT_EQ(asipctl({"replay", folder_.file("nothing")}).status, 1);
}

}  // namespace
}  // namespace asip::test
