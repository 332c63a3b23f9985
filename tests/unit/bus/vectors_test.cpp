// SPDX-License-Identifier: Apache-2.0
// The vectors that every implementation of the bus reads: tests/vectors/bus.json.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "asip/bus/request/agent_clock.hpp"
#include "asip/bus/request/demand.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/bus/topics.hpp"
#include "asip/model/names.hpp"

namespace asip::bus {
namespace {

using nlohmann::json;

const json& vectors() {
    static const json all = json::parse(std::ifstream(ASIP_VECTORS));
    return all;
}

Time at(double seconds) {
    return Time(std::chrono::microseconds(std::llround(seconds * 1e6)));
}

TEST(BusVectors, Names_AreThoseOfBoardsAndServices) {
    const auto& names = vectors().at("names");
    for (const std::string name : names.at("board"))
        EXPECT_TRUE(model::valid_board_name(name)) << name;
    for (const std::string name : names.at("service"))
        EXPECT_TRUE(model::valid_name(name)) << name;
    for (const std::string name : names.at("neither"))
        EXPECT_FALSE(model::valid_name(name)) << name;
    for (const std::string name : names.at("no_board"))
        EXPECT_FALSE(model::valid_board_name(name)) << name;
}

TEST(BusVectors, Topics_AreBuiltAlike) {
    for (const auto& vector : vectors().at("topics")) {
        const Topics topics(vector.at("root"));
        const std::string user = vector.at("user"), client = vector.at("client"), board = vector.at("board"),
                          service = vector.at("service");
        const ReplyTopics replies(topics, user, client);
        const json made{{"state", topics.state(board)},
                        {"description", topics.description(board)},
                        {"demand", topics.demand(board, user_level(user) + "/" + client)},
                        {"probe", topics.probe()},
                        {"lines", topics.board_in(board)},
                        {"command", topics.service_in(board, service)},
                        {"stop", topics.stop(board)},
                        {"event", topics.service_out(board, service)},
                        {"fault", topics.service_error(board, service)},
                        {"set", topics.service_set(board, service)},
                        {"reply", replies.to(topics.service_in(board, service))},
                        {"replies", replies.filter()},
                        {"own", replies.own()}};
        for (const auto& [name, topic] : made.items())
            EXPECT_EQ(topic, vector.at(name)) << name;
    }
}

TEST(BusVectors, Requests_AreReadAsTheyWereMeant) {
    for (const auto& vector : vectors().at("requests")) {
        const auto& payload = vector.at("payload");
        mqtt::Message message;
        message.payload = payload.dump();
        const auto read = open_envelope(message);
        ASSERT_TRUE(read) << message.payload;
        EXPECT_EQ(read->reply.topic, payload.at("reply_to").get<std::string>());
        EXPECT_EQ(read->reply.id, payload.at("id").get<std::string>());
        EXPECT_EQ(read->reply.by, payload.value("by", ""));
        EXPECT_EQ(read->reply.clock, payload.contains("clock"));
        EXPECT_EQ(read->sent, payload.value("clock", ""));
        EXPECT_EQ(read->deadline ? read->deadline->count() : 0, payload.value("deadline_ms", 0));
        EXPECT_EQ(read->hold ? read->hold->count() : 0, payload.value("hold_ms", 0));
        if (payload.contains("raw")) {
            EXPECT_EQ(read->text, payload.at("raw").get<std::string>());
        } else {
            EXPECT_EQ(read->object, vector.at("members"));
        }
    }
}

TEST(BusVectors, Answers_AreReadWithTheirStatus) {
    for (const auto& vector : vectors().at("answers")) {
        const auto reply = parse_reply(vector.at("payload").dump());
        if (!vector.contains("status")) {
            EXPECT_FALSE(reply) << vector;
            continue;
        }
        ASSERT_TRUE(reply) << vector;
        EXPECT_EQ(to_string(reply->status), vector.at("status").get<std::string>());
        EXPECT_EQ(reply->reason, vector.value("reason", ""));
        EXPECT_EQ(reply->code, vector.value("code", 0));
    }
}

TEST(BusVectors, Demands_AreReadAndWrittenAlike) {
    for (const auto& vector : vectors().at("demands")) {
        const Demand demand{vector.at("services"), std::chrono::seconds(vector.at("lease").get<int>())};
        EXPECT_EQ(json::parse(to_text(demand)), vector.at("payload"));
        const auto read = parse_demand(vector.at("payload").dump());
        ASSERT_TRUE(read) << vector;
        EXPECT_EQ(*read, demand);
    }
}

TEST(BusVectors, Clocks_ShowTheSame) {
    for (const auto& vector : vectors().at("clock")) {
        AgentClocks clocks;
        for (const auto& note : vector.at("notes"))
            clocks.note("desk", note.at(0).get<std::string>(), at(note.at(1)), at(note.at(2)));
        EXPECT_EQ(clocks.reading("desk", at(vector.at("now"))), vector.at("reading").get<std::string>())
            << vector.at("about");
    }
}

}  // namespace
}  // namespace asip::bus
