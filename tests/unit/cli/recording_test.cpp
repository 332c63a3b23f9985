// SPDX-License-Identifier: Apache-2.0
#include "cli/record/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "asip/bus/request/reply.hpp"
#include "cli/record/recording_file.hpp"
#include "cli/record/replay_board.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/unit/cli/boards.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;
using bus::TopicKind;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const bus::Topics kBus("asip");
const text::WallTime kBegan = *text::parse_iso_time("2026-11-21T10:00:00.000Z");

std::string line_of(const std::string& topic, const std::string& payload, bool retained = false) {
    mqtt::Message message;
    message.topic = topic;
    message.payload = payload;
    message.retain = retained;
    std::string text;
    append_recorded(text, *kBus.parse(topic), message, 1234567us);
    return text;
}

RecordedMessage read_back(const std::string& line) {
    auto message = parse_recorded(line);
    EXPECT_TRUE(message) << message.error() << line;
    return message && *message ? **message : RecordedMessage{};
}

TEST(Recording, EachKindOfPayload_ComesBackAsItWas) {
    const std::string deep = std::string(50, '[') + std::string(50, ']');
    for (const std::string& payload :
         {std::string(R"({"b":[1,2.5],"a":"x"})"), std::string("@D,e,1,{42}"), std::string("\"\\ \n\x1b["),
          std::string("k\xc3\xbc"
                      "che"),
          std::string("\xff\x00\x80", 3), std::string("{no json"), std::string(), deep}) {
        const auto line = line_of("asip/uno1/distance/out", payload);
        EXPECT_EQ(line.find('\n'), line.size() - 1);
        EXPECT_TRUE(nlohmann::json::accept(line)) << line;
        const auto message = read_back(line);
        EXPECT_EQ(message.payload, payload) << line;
        EXPECT_EQ(message.at, 1234567us);
    }
}

TEST(Recording, Lines_AreFitForOtherPrograms) {
    EXPECT_EQ(line_of("asip/uno1/distance/out", R"({"distance":[42]})"),
              "{\"at\":1.234567,\"what\":\"value\",\"board\":\"uno1\",\"service\":\"distance\","
              "\"data\":{\"distance\":[42]}}\n");
    EXPECT_EQ(
        line_of("asip/servicebus/uno1/$state", "online", true),
        "{\"at\":1.234567,\"what\":\"state\",\"board\":\"uno1\",\"retained\":true,\"text\":\"online\"}\n");
}

TEST(Recording, EachRecordedTopic_ComesBackUnderAnotherName) {
    for (const auto* topic :
         {"asip/uno1/distance/out", "asip/uno1/distance/error", "asip/uno1/distance/in", "asip/uno1/out",
          "asip/uno1/in", "asip/uno1/$stop", "asip/servicebus/uno1/$state",
          "asip/servicebus/uno1/$description", "asip/servicebus/uno1/$stats", "asip/servicebus/uno1/$log",
          "asip/servicebus/uno1"}) {
        const auto message = read_back(line_of(topic, "x"));
        EXPECT_EQ(message.board, "uno1");
        EXPECT_EQ(topic_of(kBus, message, "uno1"), topic);
    }
    EXPECT_EQ(read_back(line_of("asip/servicebus", "uno1")).board, "uno1");
    EXPECT_FALSE(is_recorded(TopicKind::kRegistryEvents));
    EXPECT_FALSE(is_recorded(TopicKind::kProbe));
}

TEST(Recording, FaultyLines_AreRefused) {
    for (const auto* line :
         {"", "[]", "{", R"({"at":1})", R"({"what":"value","board":"uno1","service":"x"})",
          R"({"at":-1,"what":"state","board":"uno1"})", R"({"at":1e99,"what":"state","board":"uno1"})",
          R"({"at":1,"what":"nothing","board":"uno1"})", R"({"at":1,"what":"state","board":"a/b"})",
          R"({"at":1,"what":"value","board":"uno1","service":"a b"})",
          R"({"at":1,"what":"line","board":"uno1","hex":"0g"})", R"({"at":1,"what":"line","board":7})"})
        EXPECT_FALSE(parse_recorded(line)) << line;
    EXPECT_FALSE(parse_recorded(R"({"at":1,"what":"line","board":"u","data":)" + std::string(200, '[')));
    const auto gap = parse_recorded(gap_line(5s, "broker \"x\" lost"));
    ASSERT_TRUE(gap);
    EXPECT_FALSE(*gap);
}

TEST(RecordingHeader, OnlyThatOfARecording_IsTaken) {
    EXPECT_EQ(*parse_recording_header(recording_header(kBegan)), kBegan);
    EXPECT_THAT(parse_recording_header("{}").error(), HasSubstr("asipctl record"));
    EXPECT_THAT(parse_recording_header(R"({"asip":"recording","version":2})").error(),
                HasSubstr("later version"));
    EXPECT_FALSE(parse_recording_header(R"({"asip":"recording","version":1,"began":7})"));
    EXPECT_FALSE(parse_recording_header("\xff"));
}

TEST(RecordingReader, LineThatWasBeingWritten_EndsTheRecording) {
    const test::TempDir folder;
    const auto path = folder.write("cut.jsonl", recording_header(kBegan) + line_of("asip/uno1/out", "a") +
                                                    line_of("asip/uno1/out", "b").substr(0, 20));
    auto reader = *RecordingReader::open(path);
    EXPECT_EQ((**reader.next()).payload, "a");
    EXPECT_FALSE(*reader.next());
    const auto broken = folder.write("broken.jsonl", recording_header(kBegan) + "nonsense\n");
    EXPECT_THAT(RecordingReader::open(broken)->next().error().text, HasSubstr("line 2: "));
    EXPECT_FALSE(RecordingReader::open(folder.file("nothing")));
}

TEST(RecordingWriter, WhatWasAdded_IsInTheFileInTime) {
    const test::TempDir folder;
    const auto path = folder.file("new.jsonl");
    auto writer = *RecordingWriter::create(path, false);
    const Time start{1000s};
    EXPECT_TRUE(writer.flush_due(start));
    writer.text() += "one\n";
    EXPECT_TRUE(writer.flush_due(start));
    writer.text() += "two\n";
    EXPECT_TRUE(writer.flush_due(start + RecordingWriter::kWithin - 1ms));
    EXPECT_EQ(std::filesystem::file_size(path), 4U);
    EXPECT_TRUE(writer.flush_due(start + RecordingWriter::kWithin));
    EXPECT_EQ(std::filesystem::file_size(path), 8U);
    EXPECT_THAT(RecordingWriter::create(path, false).error().text, HasSubstr("--replace"));
    EXPECT_TRUE(RecordingWriter::create(path, true));
    auto full = *RecordingWriter::create("/dev/full", true);
    full.text() += "x";
    EXPECT_THAT(full.flush().error(), HasSubstr("cannot be written"));
}

class ReplayBoardTest : public ::testing::Test {
  protected:
    static constexpr Time kStart{1000s};

    ReplayBoard board(bool described = true) {
        ReplayBoard::Identity identity{"old-uno1", "walk.jsonl", {}, {"0.1.0", "pi", "asipctl-1"}};
        identity.announcer.started_unix = 1'700'000'000;
        ReplayBoard::Recorded recorded;
        if (described) recorded.take(message(TopicKind::kDescription, kUno1));
        recorded.take(message(TopicKind::kServiceNames, "servo"));
        recorded.take(message(TopicKind::kServiceOut, R"({"distance":[1]})", "distance"));
        return {kBus, std::move(identity), recorded, [] { return 0; }};
    }

    static RecordedMessage message(TopicKind kind, const std::string& payload,
                                   const std::string& service = {}) {
        RecordedMessage result;
        result.kind = kind;
        result.board = "uno1";
        result.service = service;
        result.payload = payload;
        return result;
    }

    /// Payload of the last message to that topic.
    std::string published(const std::string& topic) const {
        std::string payload;
        for (const auto& one : out_.publish) {
            if (one.message.topic == topic) payload = one.message.payload;
        }
        return payload;
    }

    std::vector<std::string> published_all(const std::string& topic) const {
        std::vector<std::string> payloads;
        for (const auto& one : out_.publish)
            if (one.message.topic == topic) payloads.push_back(one.message.payload);
        return payloads;
    }

    void join(ReplayBoard& board) {
        board.on_connected(kStart, out_);
        board.on_subscribed(kStart, out_);
        board.tick(kStart + 1300ms, out_);
    }

    member::Announcements out_;
};

TEST_F(ReplayBoardTest, RecordedBoard_IsAnnouncedUnderItsNewNameOnceItIsFree) {
    auto recorded = board();
    EXPECT_EQ(recorded.will()->topic, "asip/servicebus/old-uno1/$state");
    EXPECT_EQ(recorded.will()->payload, "lost");
    recorded.on_connected(kStart, out_);
    EXPECT_FALSE(recorded.ready());
    out_ = {};
    join(recorded);
    ASSERT_TRUE(recorded.ready());
    const auto description = *model::parse_description(published("asip/servicebus/old-uno1/$description"));
    EXPECT_EQ(description.board, "old-uno1");
    EXPECT_EQ(description.link.kind, "replay");
    EXPECT_THAT(description.services, SizeIs(4));
    recorded.play(message(TopicKind::kState, "online"), kStart + 2s, out_);
    EXPECT_EQ(published("asip/servicebus/old-uno1/$state"), "online");
    recorded.goodbye(kStart + 3s, out_);
    EXPECT_EQ(published("asip/servicebus/old-uno1/$state"), "offline");
}

TEST_F(ReplayBoardTest, LivingHolderOfTheName_EndsIt) {
    auto recorded = board();
    recorded.on_connected(kStart, out_);
    mqtt::Message holder;
    holder.topic = "asip/servicebus/old-uno1/$description";
    holder.payload = R"({"board":"old-uno1","session":"zz","seq":1,"services":[]})";
    recorded.on_message(holder, kStart, out_);
    ASSERT_TRUE(out_.fatal);
    EXPECT_THAT(out_.fatal->text, HasSubstr("is held by"));
}

TEST_F(ReplayBoardTest, WhatWasSaid_IsSaidAgainAndWhatWasAskedIsNot) {
    auto recorded = board();
    join(recorded);
    out_ = {};
    recorded.play(message(TopicKind::kServiceIn, "W,0,90", "servo"), kStart + 2s, out_);
    recorded.play(message(TopicKind::kBoardIn, "#,R"), kStart + 2s, out_);
    recorded.play(message(TopicKind::kStop, ""), kStart + 2s, out_);
    auto stale = message(TopicKind::kServiceOut, "{}", "distance");
    stale.retained = true;
    recorded.play(stale, kStart + 2s, out_);
    EXPECT_THAT(out_.publish, IsEmpty());
    recorded.play(message(TopicKind::kServiceOut, R"({"distance":[1]})", "distance"), kStart + 2s, out_);
    EXPECT_EQ(published("asip/old-uno1/distance/out"), R"({"distance":[1]})");
}

TEST_F(ReplayBoardTest, Command_IsRefusedWithItsReason) {
    auto recorded = board();
    join(recorded);
    out_ = {};
    mqtt::Message command;
    command.topic = "asip/old-uno1/servo/in";
    command.payload = R"({"write":[0,90],"reply_to":"me","id":"7"})";
    recorded.on_message(command, kStart, out_);
    const auto reply = bus::parse_reply(published("me"));
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, bus::Reply::Status::kRefused);
    EXPECT_EQ(reply->reason, kRefusedRecorded);
    command.payload = "W,0,90";
    out_ = {};
    recorded.on_message(command, kStart, out_);
    EXPECT_THAT(out_.publish, IsEmpty()) << "nobody wants an answer";
}

TEST_F(ReplayBoardTest, BoardOfNamesOnly_PublishesThem) {
    auto names = board(false);
    EXPECT_FALSE(names.will());
    names.on_connected(kStart, out_);
    ASSERT_TRUE(names.ready());
    EXPECT_EQ(published("asip/servicebus"), "old-uno1");
    EXPECT_EQ(published_all("asip/servicebus/old-uno1"), (std::vector<std::string>{"distance", "servo"}));
    out_ = {};
    names.play(message(TopicKind::kBoardNames, "uno1"), kStart, out_);
    EXPECT_EQ(published("asip/servicebus"), "") << "not under its old name";
    names.tick(kStart + 19s, out_);
    EXPECT_THAT(out_.publish, IsEmpty());
    names.tick(kStart + 21s, out_);
    EXPECT_EQ(published("asip/servicebus"), "old-uno1") << "a name holds for a minute";
}

}  // namespace
}  // namespace asip::cli
