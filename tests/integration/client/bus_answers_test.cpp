// SPDX-License-Identifier: Apache-2.0
// What a command over MQTT carries, and what its answers become, with a plain client in the place of the
// agent.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include <nlohmann/json.hpp>

#include "asip/client/blocking_board.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::client {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

constexpr const char* kCommands = "asip/uno1/io/in";

class BusAnswers : public ::testing::Test {
  protected:
    BusAnswers() {
        agent_.publish("asip/servicebus/uno1/$description",
                       R"({"board":"uno1","session":"a","seq":1,"lease":60,)"
                       R"("services":[{"name":"io","id":"I","model":"io@1"}]})",
                       true);
        agent_.publish("asip/servicebus/uno1/$state", "online", true);
        Options options;
        options.command_timeout = 1500ms;
        auto opened = BlockingBoard::open(broker_.url() + "/uno1", options);
        if (!opened) throw std::runtime_error(to_string(opened.error()));
        board_ = std::move(*opened);
    }

    /// What a command ends with when the agent answers `reply`.
    Error ends_with(const std::string& reply) {
        agent_.clear();
        auto call = std::async(std::launch::async, [this] { return board_.digital_write(13, true); });
        const auto command = agent_.wait_for(kCommands);
        if (command) {
            command_ = *command;
            agent_.publish(mqtt::Message{.topic = command->response_topic,
                                         .payload = reply,
                                         .qos = 1,
                                         .correlation = command->correlation});
        }
        const auto done = call.get();
        return done ? Error{Error::Kind::kClosed, -1, "succeeded"} : done.error();
    }

    test::MosquittoBroker broker_;
    test::BusProbe agent_{broker_.port()};
    BlockingBoard board_;
    mqtt::Message command_;
};

TEST_F(BusAnswers, Command_CarriesItsDeadline) {
    EXPECT_EQ(ends_with(R"({"status":"ok","proof":"fence"})").text, "succeeded");
    EXPECT_EQ(json::parse(command_.payload).at("deadline_ms"), 1500);
    EXPECT_LE(command_.expiry_seconds.value_or(0), 2u);
    EXPECT_GT(command_.expiry_seconds.value_or(0), 0u);
}

TEST_F(BusAnswers, TimeoutInDoubt_SaysThatItMayHaveBeenExecuted) {
    const Error doubt = ends_with(R"({"status":"timeout","reason":"doubt"})");
    EXPECT_EQ(doubt.kind, Error::Kind::kTimeout);
    EXPECT_THAT(doubt.text, HasSubstr("it may or may not have been executed"));
    const Error late = ends_with(R"({"status":"timeout"})");
    EXPECT_EQ(late.kind, Error::Kind::kTimeout);
    EXPECT_THAT(late.text, HasSubstr("gave no proof in time; it may or may not have been executed"));
}

TEST_F(BusAnswers, Refusals_AreInvalidUnreachableOrRefused) {
    EXPECT_EQ(ends_with(R"({"status":"refused","reason":"invalid","error":"pin: 99 is above 69"})"),
              (Error{Error::Kind::kInvalid, 0, "pin: 99 is above 69"}));
    EXPECT_EQ(ends_with(R"({"status":"refused","reason":"board-not-there","error":"gone"})").kind,
              Error::Kind::kUnreachable);
    EXPECT_EQ(ends_with(R"({"status":"refused","reason":"queue-full"})"),
              (Error{Error::Kind::kRefused, 0, "too many commands wait"}));
    EXPECT_EQ(ends_with(R"({"status":"error","code":6,"error":"WRONG_MODE"})"),
              (Error{Error::Kind::kBoard, 6, "WRONG_MODE"}));
}

TEST_F(BusAnswers, NobodyAnswers_TheCallEndsSoonAfterItsDeadline) {
    const auto began = std::chrono::steady_clock::now();
    const auto done = board_.digital_write(13, true);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, Error::Kind::kTimeout);
    EXPECT_GE(std::chrono::steady_clock::now() - began, 1500ms);
}

TEST_F(BusAnswers, Values_AreThoseOfTheService) {
    const auto say = [&](const std::string& values) {
        agent_.publish("asip/uno1/$values",
                       R"({"version":1,"board":"uno1","session":"a","seq":2,"values":)" + values + "}", true);
    };
    say(R"({"io/13":{"value":true,"how":"set","age":0.5},"io/2":{"unknown":"never","age":1},)"
        R"("servo/0/angle":{"value":90,"how":"set","age":1}})");
    const json known{{"io/13", true}};
    EXPECT_TRUE(test::wait_until([&] { return board_.values("io") == known; })) << board_.values("io");
    agent_.publish("asip/uno1/$values", "{\"version\":1,", true);
    say("[]");
    agent_.publish("asip/uno1/io/set", R"({"write":{"13":0}})", true);
    say(R"({"io/13":{"value":false,"how":"set","age":0.5}})");
    EXPECT_TRUE(test::wait_until([&] { return board_.values("io") == json{{"io/13", false}}; }))
        << board_.values("io");
}

}  // namespace
}  // namespace asip::client
