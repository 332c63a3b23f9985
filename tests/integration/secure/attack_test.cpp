// SPDX-License-Identifier: Apache-2.0
// What users of a secured bus try against its programs with the credentials that they have.
#include <gmock/gmock.h>

#include <csignal>
#include <set>

#include "asip/bus/topics.hpp"
#include "tests/integration/secure/running_bus.hpp"
#include "tests/support/patterns.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class AttackedBus : public RunningBus {
  protected:
    /// The name that a program publishes as its own; the last level of its reply topics and demands.
    std::string published_name_of_the_agent() const {
        auto admin = probe("admin", {"asip/servicebus/uno/$description"});
        const auto description = admin.wait_for("asip/servicebus/uno/$description");
        if (!description) return {};
        const auto begin = description->payload.find("asip-agent-");
        return begin == std::string::npos
                   ? std::string()
                   : description->payload.substr(begin, description->payload.find('"', begin) - begin);
    }
    /// Whether the broker takes a message of so many bytes, with QoS 1.
    bool publishes(const std::string& user, const std::string& topic, std::size_t bytes) const {
        const auto options = probe_options(user);
        const auto payload = place_.write("payload", std::string(bytes, 'x'));
        return run({"mosquitto_pub", "-V", "5", "-q", "1", "-h", "localhost", "-p", std::to_string(port()),
                    "--cafile", options.ca, "-u", options.user, "-P", options.password, "-t", topic, "-f",
                    payload},
                   {}, std::chrono::seconds(5))
                   .status == 0;
    }
    /// From a request of the gateway: where it waits for answers of board uno.
    std::string reply_topic_of_the_gateway() const {
        auto admin = probe("admin", {"asip/reply/gateway/uno/#"});
        EXPECT_TRUE(gateway_commands());
        const auto answer = admin.wait_for([](const mqtt::Message&) { return true; });
        return answer ? answer->topic : std::string();
    }
};

/// A hundred sizes for each topic at which Mosquitto takes a message on the way in and may find it too large
/// on the way out.
TEST_F(AttackedBus, MessagesOfEverySizeAroundTheLimit_MakeNobodyDeaf) {
    auto gateways = reply_topic_of_the_gateway();
    ASSERT_NE(gateways, "");
    gateways.replace(gateways.find("/uno/"), 5, "/uno2/");
    const std::vector<std::pair<std::string, std::string>> targets{
        {"bob", "asip/servicebus/$probe"},
        {"bob", "asip/registry/query"},
        {"bob", "asip/registry/hall/query"},
        {"bob", "asip/servicebus/uno/$demand/bob/c1"},
        {"ann", "asip/uno/in"},
        {"ann", "asip/uno/io/in"},
        {"ann", "asip/uno/$stop"},
        {"uno2", "asip/servicebus/uno2/$description"},
        {"uno2", gateways},
    };
    for (const auto& [user, topic] : targets) {
        bool taken = true;
        for (int below = 200; below >= 0 && taken; below -= below > 50 ? 3 : 1)
            taken = publishes(user, topic,
                              bus::kBrokerPacketBytes - static_cast<std::size_t>(below) - topic.size());
        EXPECT_FALSE(taken) << "the broker has a limit";
    }
    EXPECT_TRUE(agent_answers()) << agent_->errors();
    EXPECT_TRUE(registry_answers()) << registry_->errors();
    EXPECT_TRUE(gateway_commands()) << gateway_->errors();
}

TEST_F(AttackedBus, PublishedNamesOfPrograms_ThrowNobodyOut) {
    const auto agent = published_name_of_the_agent();
    const auto gateways = reply_topic_of_the_gateway();
    ASSERT_NE(agent, "");
    ASSERT_NE(gateways, "");
    std::vector<std::string> names{agent};
    // asip/reply/USER/BOARD/CLIENT[/PART]
    std::string level;
    for (std::istringstream levels(gateways); std::getline(levels, level, '/');)
        if (level.starts_with("asip-")) names.push_back(level);
    ASSERT_EQ(names.size(), 2U) << gateways;
    auto watcher = probe("bob", {"asip/servicebus/uno/$state"});
    for (const auto& name : names) {
        for (int i = 0; i < 10; ++i) {
            auto options = probe_options("bob");
            options.client_id = name;
            BusProbe thief(port(), {"asip/servicebus/$probe"}, options);
        }
    }
    EXPECT_TRUE(agent_answers());
    EXPECT_TRUE(gateway_commands());
    for (const auto& message : watcher.messages())
        EXPECT_EQ(message.payload, "online");
    EXPECT_THAT(agent_->errors(), Not(HasSubstr("broker lost")));
    EXPECT_THAT(gateway_->errors(), Not(HasSubstr("connection lost")));
}

/// Topics on which a viewer, or an operator, may not write, and answerers may.
TEST_F(AttackedBus, AnswersGoOnlyWhereAnswersMayGo) {
    auto admin = probe("admin", {"asip/#"});
    auto bob = probe("bob", {});
    auto ann = probe("ann", {});
    const auto ask = [](BusProbe& who, const std::string& topic, const std::string& payload,
                        const std::string& reply) {
        who.publish(mqtt::Message{.topic = topic,
                                  .payload = payload,
                                  .qos = 1,
                                  .response_topic = reply,
                                  .correlation = "attack-1"});
    };
    for (const char* reply : {"asip/uno/io/out", "asip/uno/out", "asip/uno/in", "asip/uno/io/in",
                              "asip/uno/$stop", "asip/servicebus/uno/$state", "asip/registry/hall/$state",
                              "asip/registry/hall/events", "asip/registry/query", "asip/reply/bob/uno/x",
                              "asip/reply/bob/registry", "asip/reply/bob", "elsewhere"}) {
        ask(bob, "asip/registry/query", R"({"find":"boards"})", reply);
        ask(bob, "asip/registry/hall/query", "not a query", reply);
        bob.publish("asip/registry/hall/query",
                    std::string(R"({"find":"boards","id":"attack-2","reply_to":")") + reply + "\"}");
    }
    for (const char* reply : {"asip/uno/io/out", "asip/uno/out", "asip/uno/distance/error", "asip/uno/io/in",
                              "asip/servicebus/uno/$state", "asip/servicebus/uno/$log",
                              "asip/reply/ann/uno2/x", "asip/reply/ann/uno", "asip/reply/ann/registry/x"}) {
        for (const char* topic : {"asip/uno/in", "asip/uno/io/in", "asip/uno/$stop"}) {
            ask(ann, topic, "#,?", reply);
            ask(ann, topic, R"({"labels":{}})", reply);
            ann.publish(topic, std::string(R"({"raw":"#,?","id":"attack-2","reply_to":")") + reply + "\"}");
        }
    }
    EXPECT_TRUE(agent_answers());
    EXPECT_TRUE(registry_answers());
    for (const auto& message : admin.messages()) {
        const bool asked = message.topic.ends_with("/in") || message.topic.ends_with("/query") ||
                           message.topic.ends_with("/$stop");
        const bool answer =
            !asked && (!message.correlation.empty() || message.payload.find("attack-2") != std::string::npos);
        EXPECT_TRUE(!answer || message.topic.starts_with("asip/reply/"))
            << message.topic << " " << message.payload;
        EXPECT_FALSE(asked && message.payload.find("\"status\"") != std::string::npos) << message.payload;
    }
    EXPECT_EQ(admin.count("asip/reply/ann/uno2/x") + admin.count("asip/reply/ann/registry/x") +
                  admin.count("asip/reply/bob/uno/x"),
              0U);
    for (const auto* program : {agent_.get(), registry_.get()}) {
        EXPECT_THAT(program->errors(), HasSubstr("names a topic for its answer"))
            << "an operator can find it";
        EXPECT_THAT(program->errors(), Not(HasSubstr("lost")));
    }
    EXPECT_EQ(broker_log().find("uno disconnected"), std::string::npos) << broker_log();
}

/// What a board that is lost left behind is what alarms are built on.
TEST_F(AttackedBus, Viewer_HasNoBoardForgotten) {
    auto uno2 = probe("uno2", {});
    uno2.publish("asip/servicebus/uno2/$state", "lost", true);
    const auto lost = [&] { return asipctl("bob", {"list", "--state", "lost", "-o", "name"}).output; };
    ASSERT_TRUE(wait_until([&] { return lost() == "uno2\n"; }));
    auto bob = probe("bob", {"asip/reply/bob/registry/x", "asip/servicebus/uno2/$state"});
    for (const char* topic : {"asip/registry/query", "asip/registry/hall/query", "asip/registry/forget",
                              "asip/registry/hall/forget"}) {
        for (const char* board : {"uno2", "*"}) {
            mqtt::Message forget{.topic = topic,
                                 .payload = std::string(R"({"forget":")") + board + "\"}",
                                 .qos = 1,
                                 .response_topic = "asip/reply/bob/registry/x",
                                 .correlation = topic};
            bob.publish(forget);
        }
    }
    EXPECT_TRUE(bob.wait_for([](const mqtt::Message& message) {
        return message.correlation == "asip/registry/hall/query" &&
               message.payload.find(R"("refused":"denied")") != std::string::npos;
    }));
    ASSERT_TRUE(wait_until([&] { return bob.all_acknowledged(); }));
    const auto verb = asipctl("bob", {"forget", "uno2"});
    EXPECT_NE(verb.status, 0);
    EXPECT_THAT(verb.errors, HasSubstr("asip/registry/hall/forget"));
    EXPECT_EQ(lost(), "uno2\n");
    for (const auto& message : bob.messages()) {
        EXPECT_NE(message.payload, "") << message.topic;
        EXPECT_EQ(message.payload.find("\"forgotten\":["), std::string::npos) << message.payload;
    }
    const auto operators = asipctl("ann", {"forget", "uno2"});
    EXPECT_EQ(operators.status, 0) << operators.errors;
    EXPECT_TRUE(wait_until([&] { return lost().empty(); }));
}

/// The client that asks names the topic of the answer, and a message carries no user of the broker. What
/// keeps others away from it is its last level: random, and read by those alone that are asked.
TEST_F(AttackedBus, NamesInReplyTopics_AreReadByNobodyElse) {
    auto admin = probe("admin", {"asip/#"});
    auto bob =
        probe("bob", {"#", "asip/#", "asip/+/in", "asip/+/+/in", "asip/+/$stop", "asip/registry/+/query",
                      "asip/reply/#", "asip/servicebus/#", "asip/servicebus/+/$demand/#"});
    auto uno2 = probe("uno2", {"#", "asip/#", "asip/servicebus/#"});
    EXPECT_EQ(asipctl("ann", {"send", "uno", "--raw", "#,?"}).status, 0);
    EXPECT_EQ(asipctl("ann", {"list"}).status, 0);
    EXPECT_TRUE(gateway_commands());
    // What a registry asks itself when it starts names its reply topics, too.
    registry_ = std::make_unique<ChildProcess>(Words{ASIP_TEST_REGISTRY, "--id", "hall"} + as("registry"));
    ASSERT_TRUE(becomes_online()) << registry_->errors();
    std::set<std::string> names;  // the last level of each topic for answers
    std::set<std::string> random;
    for (const auto& message : admin.messages()) {
        const auto& topic = message.topic.starts_with("asip/reply/") ? message.topic : message.response_topic;
        if (topic.starts_with("asip/reply/bob/")) continue;  // its own
        if (topic.starts_with("asip/reply/")) names.insert(topic.substr(topic.rfind('/') + 1));
        // From requests without properties; and the random part alone, which may stand elsewhere.
        for (const auto& text : {topic, message.payload}) {
            const auto at = text.find("asip/reply/");
            if (at == std::string::npos || text.compare(at, 15, "asip/reply/bob/") == 0) continue;
            const auto whole = text.substr(at, text.find('"', at) - at);
            for (const auto& match : all_matches(whole, "[0-9a-f]{8,}"))
                random.insert(match[0]);
        }
    }
    names.erase("$self");
    ASSERT_GE(names.size(), 3U);
    ASSERT_GE(random.size(), 3U);
    names.insert(random.begin(), random.end());
    std::string heard;
    for (const auto* listener : {&bob, &uno2})
        for (const auto& message : listener->messages())
            heard += message.topic + " " + message.response_topic + " " + message.payload + "\n";
    EXPECT_THAT(heard, HasSubstr("asip/servicebus/uno/$description"));
    for (const auto& name : names) {
        if (name.size() < 12 && !random.contains(name)) continue;  // a part of a program: behind its name
        EXPECT_EQ(heard.find(name), std::string::npos) << name << " in\n" << heard;
    }
}

/// With `max_queued_messages 0` Mosquitto 2.0 closes it.
TEST_F(AttackedBus, DeniedMessage_LeavesTheConnectionOpen) {
    for (const char* user : {"bob", "ann", "uno2", "registry", "gateway"}) {
        auto who = probe(user, {});
        who.publish("asip/uno/nowhere", "x");
        who.publish("asip/servicebus/$probe", "nobody");
        ASSERT_TRUE(wait_until([&] { return who.all_acknowledged(); })) << user;
        EXPECT_EQ(who.reconnects(), 0) << user;
    }
}

TEST_F(AttackedBus, RevokedOperator_ItsLinksEndAndThoseOfOthersGoOn) {
    const Words reload{"--reload-pid", std::to_string(broker_->pid())};
    ASSERT_EQ(secure(Words{"add", "operator", "zoe"} + reload).status, 0);
    ASSERT_TRUE(wait_until([&] { return asipctl("zoe", {"pin", "uno", "2", "pullup"}).status == 0; }));
    for (const std::string user : {"ann", "zoe"})
        EXPECT_TRUE(wait_until([&] {
            return asipctl(user, {"link", "uno/io/2", "uno/io", "--send", R"({"write":[13,1]})", "--name",
                                  "of-" + user})
                       .status == 0;
        })) << user;
    const auto links = [this] { return asipctl("bob", {"link", "list"}).output; };
    EXPECT_TRUE(wait_until([&] { return links().find("of-zoe") != std::string::npos; })) << links();
    EXPECT_NE(asipctl("zoe", {"link", "remove", "of-ann"}).status, 0);
    EXPECT_NE(asipctl("bob", {"link", "remove", "of-ann"}).status, 0) << "a viewer";
    const auto revoked = secure(Words{"revoke", "zoe"} + reload);
    EXPECT_THAT(revoked.output, HasSubstr("the links that zoe set at uno")) << revoked.errors;
    EXPECT_TRUE(wait_until([&] { return links().find("of-zoe") == std::string::npos; })) << links();
    EXPECT_THAT(links(), HasSubstr("of-ann"));
    agent_->signal(SIGKILL);
    agent_->wait_exit();
    const auto missed = secure(Words{"revoke", "ann"} + reload);
    EXPECT_THAT(missed.output + missed.errors, HasSubstr("the agent of uno was not reached"));
    EXPECT_THAT(links(), HasSubstr("of-ann"));
}

}  // namespace
}  // namespace asip::test
