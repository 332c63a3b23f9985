// SPDX-License-Identifier: Apache-2.0
// A registry over a scripted connection: messages and times in, messages out.
#include "registry/registry.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <deque>
#include <nlohmann/json.hpp>
#include <set>

#include "history_files.hpp"
#include "messages.hpp"

namespace asip::registry {
namespace registry_test {

using nlohmann::json;

class Connection {
  public:
    Port port() {
        Port port;
        port.publish = [this](mqtt::Message message) { published.push_back(std::move(message)); };
        port.subscribe = [](const std::string&, bool) {};
        port.unsubscribe = [](const std::string&) {};
        return port;
    }
    /// The newest message on a topic, as JSON.
    json last(const std::string& topic) const {
        for (auto message = published.rbegin(); message != published.rend(); ++message)
            if (message->topic == topic) return json::parse(message->payload, nullptr, false);
        return json();
    }
    std::size_t count(const std::string& topic) const {
        return static_cast<std::size_t>(std::count_if(
            published.begin(), published.end(), [&](const auto& message) { return message.topic == topic; }));
    }

    std::deque<mqtt::Message> published;
};

Instant moment(Duration since_start) {
    return {at(since_start),
            wall(1'700'000'000'000) + std::chrono::duration_cast<std::chrono::milliseconds>(since_start)};
}

RegistryOptions options() {
    RegistryOptions result;
    result.id = "r1";
    return result;
}

Random counting() {
    return [next = std::uint64_t{1}]() mutable { return next += 0x9e3779b97f4a7c15; };
}

mqtt::Message bus_message(const std::string& topic, const std::string& payload, bool retained = false) {
    return mqtt::Message{.topic = topic, .payload = payload, .retain = retained};
}

/// Where the registry's own marks come back to it.
const std::string kMarks = "asip/reply/$nobody/registry/";

/// One run of a registry, with the history of the runs before.
class RegistryRun {
  public:
    RegistryRun(const std::string& history_file, Duration start, RegistryOptions with = options())
        : keeper_(io_, {.path = history_file},
                  {.failed = [](const std::string& why) { ADD_FAILURE() << why; },
                   .works_again = {},
                   .begun_anew = {}},
                  "boot", moment(start)),
          registry(with, {}, counting(), connection.port(), &keeper_, moment(start)) {
        registry.connected(0, moment(start));
    }
    /// Everything retained was delivered.
    void complete(Duration now) {
        for (std::size_t i = 0; i < connection.published.size(); ++i) {
            const mqtt::Message message = connection.published[i];
            if (message.topic == "asip/registry/r1/query" || message.topic.starts_with(kMarks))
                registry.message(message, moment(now));
        }
    }
    json ask(const std::string& query, Duration now) {
        mqtt::Message message = bus_message("asip/registry/query", query);
        message.response_topic = "answers";
        const auto before = connection.count("answers");
        registry.message(message, moment(now));
        while (connection.count("answers") == before && io_.run_one() > 0) {
        }
        return connection.last("answers");
    }

    Connection connection;

  private:
    boost::asio::io_context io_;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    HistoryKeeper keeper_;

  public:
    Registry registry;
};

const std::string kState = "asip/servicebus/uno1/$state";

/// A client that reads what a registry publishes for all clients learns nothing of its reply topics: with
/// their names a viewer could have answers sent there.
TEST(Registry, RandomLevelsOfItsReplyTopics_ArePublishedNowhere) {
    const HistoryFile file;
    RegistryRun run(file.path(), 0s);
    run.complete(0s);
    run.ask(R"({"find":"boards"})", 1s);
    for (int i = 0; i < 30; ++i)
        run.registry.tick(moment(std::chrono::seconds(i)));
    std::set<std::string> secrets;  // each run of hexadecimal digits that could be one
    std::string everybody;
    for (const auto& message : run.connection.published) {
        const bool to_registries = message.topic.ends_with("/query");
        if (!to_registries && !message.topic.starts_with(kMarks))
            everybody += message.topic + " " + message.payload + "\n";
        const auto at = message.payload.find("asip/reply/");
        if (!to_registries || at == std::string::npos) continue;
        const auto topic = message.payload.substr(at, message.payload.find('"', at) - at);
        for (std::size_t from = 0; from < topic.size();) {
            const auto end = std::min(topic.find_first_not_of("0123456789abcdef", from), topic.size());
            if (end - from >= 8) secrets.insert(topic.substr(from, end - from));
            from = end + 1;
        }
    }
    ASSERT_EQ(secrets.size(), 1u);
    EXPECT_THAT(everybody, testing::HasSubstr("epoch"));
    EXPECT_EQ(everybody.find(*secrets.begin()), std::string::npos) << everybody;
}

TEST(RegistryWithHistory, StartedAgain_TimesAndForgettingGoOnAndNothingIsAddedTwice) {
    const HistoryFile file;
    RegistryOptions forgetful = options();
    forgetful.forget_after = 7 * 24h;
    json before;
    {
        RegistryRun run(file.path(), 0s, forgetful);
        run.complete(0s);
        run.registry.message(bus_message("asip/servicebus/uno1/$description", description("uno1").payload),
                             moment(1s));
        run.registry.message(bus_message(kState, "lost"), moment(100s));
        before = run.ask(R"({"find":"boards"})", 100s).at("items").at(0);
        EXPECT_EQ(before.at("first_seen"), text::iso_time(moment(1s).wall));
        EXPECT_EQ(before.at("since"), text::iso_time(moment(100s).wall));
    }
    RegistryRun run(file.path(), 6 * 24h, forgetful);
    run.registry.message(bus_message(kState, "lost", true), moment(6 * 24h));
    run.complete(6 * 24h);
    const json after = run.ask(R"({"find":"boards"})", 6 * 24h).at("items").at(0);
    EXPECT_EQ(after.at("first_seen"), before.at("first_seen"));
    EXPECT_EQ(after.at("since"), before.at("since"));
    const json history = run.ask(R"({"find":"history"})", 6 * 24h).at("items");
    ASSERT_EQ(history.size(), 2u) << history;
    EXPECT_EQ(history.at(0).at("was"), "online");
    EXPECT_EQ(history.at(1).at("what"), "added");
    Duration time = 7 * 24h + 101s;
    for (const Duration end = time + 15s; time < end; time += 1s)
        run.registry.tick(moment(time));
    EXPECT_EQ(run.ask(R"({"find":"boards"})", time).at("items").size(), 0u)
        << "forgotten seven days after it was lost, not after the restart";
}

TEST(RegistryWithHistory, BoardLongDueWhenTheRegistryStarts_IsHeardBeforeItIsForgotten) {
    const HistoryFile file;
    {
        RegistryRun run(file.path(), 0s);
        run.complete(0s);
        run.registry.message(bus_message(kState, "lost"), moment(1s));
    }
    RegistryRun run(file.path(), 30 * 24h);
    run.registry.message(bus_message(kState, "online", true), moment(30 * 24h));
    run.complete(30 * 24h);
    run.registry.tick(moment(30 * 24h + 1s));
    run.registry.message(bus_message("asip/servicebus/uno1/$description", description("uno1").payload),
                         moment(30 * 24h + 2s));
    EXPECT_EQ(run.ask(R"({"find":"boards"})", 30 * 24h + 3s).at("items").at(0).at("state"), "online");
    EXPECT_EQ(run.connection.count(kState), 0u) << "nothing of it was cleared";
}

TEST(RegistryWithHistory, NamesOnlyBoardThatLeftMeanwhile_DoesNotStayOnline) {
    const HistoryFile file;
    {
        RegistryRun run(file.path(), 0s);
        run.complete(0s);
        run.registry.message(bus_message("asip/servicebus", "esp1"), moment(1s));
    }
    RegistryRun run(file.path(), 1h);
    run.complete(1h);
    run.registry.tick(moment(1h + 100s));
    const json history = run.ask(R"({"find":"history","board":"esp1"})", 1h + 101s).at("items");
    ASSERT_EQ(history.size(), 2u);
    EXPECT_EQ(history.at(0).at("state"), "lost");
    EXPECT_EQ(history.at(0).at("reason"), "expired");
}

class RegistryTest : public testing::Test {
  protected:
    RegistryTest() { registry.connected(0, moment(0s)); }
    /// On this topic, or below it.
    mqtt::Message sent(const std::string& topic, std::size_t index = 0) const {
        for (const auto& message : connection.published)
            if (message.topic.starts_with(topic) && index-- == 0) return message;
        ADD_FAILURE() << "nothing on " << topic;
        return {};
    }

    Connection connection;
    Registry registry{options(), {}, counting(), connection.port(), nullptr, moment(0s)};
};

TEST_F(RegistryTest, ItsOwnProbeAndStatistics_AreNoOtherRegistry) {
    registry.message(sent("asip/registry/r1/query", 0), moment(0s));
    registry.message(sent(kMarks), moment(0s));
    registry.message(sent("asip/registry/r1/$stats"), moment(0s));
    EXPECT_FALSE(registry.id_taken_by());
}

TEST_F(RegistryTest, AnotherOfItsIdAnswersTheProbe_TheIdIsTaken) {
    Connection other_connection;
    Registry other(
        options(), {}, [] { return std::uint64_t{7}; }, other_connection.port(), nullptr, moment(0s));
    other.connected(0, moment(0s));
    other.message(sent("asip/registry/r1/query", 0), moment(1s));
    registry.message(other_connection.published.back(), moment(1s));
    ASSERT_TRUE(registry.id_taken_by());
    EXPECT_NE(*registry.id_taken_by(), "");
}

TEST_F(RegistryTest, AnotherOfItsIdStartsLater_IsNoReasonToEnd) {
    Connection other_connection;
    Registry other(
        options(), {}, [] { return std::uint64_t{7}; }, other_connection.port(), nullptr, moment(0s));
    other.connected(0, moment(0s));
    other.message(sent("asip/registry/r1/query", 0), moment(1s));
    registry.message(other_connection.published.back(), moment(60s));
    EXPECT_FALSE(registry.id_taken_by());
}

TEST_F(RegistryTest, ConnectionAgain_RetainedMessagesDoNotHoldUpAnswers) {
    const std::string state = "asip/registry/r1/$state";
    const std::string statistics = "asip/registry/r1/$stats";
    registry.message(sent(kMarks), moment(0s));
    registry.disconnected();
    connection.published.clear();
    registry.connected(0, moment(30s));
    EXPECT_EQ(connection.published.back().topic, state) << "probes go before it";
    registry.message(sent(kMarks), moment(30s));
    registry.tick(moment(31s));
    EXPECT_EQ(connection.count(statistics), 0u);
    for (Duration time = 32s; time <= 45s; time += 1s)
        registry.tick(moment(time));
    EXPECT_GE(connection.count(statistics), 1u);
}

TEST_F(RegistryTest, WillOfAnEarlierConnectionComesLate_ItSaysAgainThatItIsOnline) {
    const std::string state = "asip/registry/r1/$state";
    const auto before = connection.count(state);
    registry.message(bus_message(state, "offline", true), moment(1s));  // of the run before
    registry.message(bus_message(state, "online"), moment(1s));
    registry.tick(moment(3s));
    EXPECT_EQ(connection.count(state), before);
    registry.message(bus_message(state, "lost"), moment(4s));
    for (Duration time = 5s; time <= 8s; time += 1s)
        registry.tick(moment(time));
    EXPECT_EQ(connection.count(state), before + 1);
    EXPECT_EQ(connection.published.back().payload, "online");
}

TEST_F(RegistryTest, NamesThatAreNone_AreCountedWhereverTheyStand) {
    registry.message(bus_message("asip/servicebus/un o/$state", "online"), moment(0s));
    registry.message(bus_message("asip/servicebus/registry/$state", "online"), moment(0s));
    registry.message(bus_message("asip/servicebus", "un o"), moment(0s));
    registry.message(sent(kMarks), moment(1s));
    for (Duration time = 2s; time <= 30s; time += 1s)
        registry.tick(moment(time));
    EXPECT_EQ(connection.last("asip/registry/r1/$stats").at("refused"), json({{"bad-name", 3}}));
}

TEST_F(RegistryTest, ChangesBeforeTheCatalogueIsComplete_AreOneReset) {
    const std::string events = "asip/registry/r1/events";
    registry.message(bus_message("asip/servicebus/uno1/$description", description("uno1").payload),
                     moment(0s));
    EXPECT_EQ(connection.count(events), 0u);
    registry.message(sent(kMarks), moment(0s));
    EXPECT_EQ(connection.count(events), 1u);
    EXPECT_EQ(connection.last(events).at("event"), "reset");
    EXPECT_EQ(connection.last(events).at("seq"), 1u);
    registry.message(bus_message(kState, "sleeping"), moment(1s));
    EXPECT_EQ(connection.last(events).at("seq"), 2u);
    EXPECT_EQ(connection.last(events).at("was"), "online");
}

TEST_F(RegistryTest, NamesOnlyBoardWhoseDescriptionWasMissed_IsAskedAndThenDescribed) {
    registry.message(sent(kMarks), moment(0s));
    registry.message(bus_message("asip/servicebus", "uno1"), moment(1s));
    const auto probes = connection.count("asip/servicebus/$probe");
    registry.tick(moment(1500ms));
    for (Duration time = 2s; time < 10s; time += 100ms)
        registry.tick(moment(time));
    ASSERT_EQ(connection.count("asip/servicebus/$probe"), probes + 1);
    EXPECT_EQ(sent("asip/servicebus/$probe", probes).payload, "uno1");
    registry.message(bus_message("asip/servicebus/uno1/$description", description("uno1").payload),
                     moment(10s));
    mqtt::Message query = bus_message("asip/registry/query", R"({"find":"boards","board":"uno1"})");
    query.response_topic = "answers";
    registry.message(query, moment(11s));
    EXPECT_EQ(connection.last("answers").at("items").at(0).value("names_only", false), false);
}

TEST(Registry, Answers_DoNotWaitBehindWhatIsToldOfChanges) {
    Connection connection, answers;
    auto port = connection.port();
    port.answer = answers.port().publish;
    Registry registry(options(), {}, counting(), port, nullptr, moment(0s));
    registry.connected(0, moment(0s));
    mqtt::Message query = bus_message("asip/registry/query", R"({"find":"boards"})");
    query.response_topic = "answers";
    registry.message(query, moment(1s));
    EXPECT_EQ(answers.count("answers"), 1u);
    EXPECT_EQ(connection.count("answers"), 0u);
}

// What users may write without bound comes over the connection of answers: beside a flood of it nothing of
// boards waits. A program that reads "online" may ask.
TEST(Registry, QuestionsAndTheirAnswers_HaveAConnectionThatSaysWhenTheyAreHeard) {
    Connection connection, answers;
    auto port = connection.port();
    port.answer = answers.port().publish;
    Registry registry(options(), {}, counting(), port, nullptr, moment(0s));
    EXPECT_THAT(registry.questions(),
                testing::UnorderedElementsAre("asip/registry/query", "asip/registry/r1/query",
                                              "asip/registry/forget", "asip/registry/r1/forget"));
    for (const auto& [filter, qos, retained] : registry.subscriptions())
        EXPECT_FALSE(filter.ends_with("/query") || filter.ends_with("/forget")) << filter;
    registry.connected(0, moment(0s));
    EXPECT_EQ(answers.published.back().topic, "asip/registry/r1/$state");
    EXPECT_EQ(answers.published.back().payload, "online");
    EXPECT_EQ(connection.count("asip/registry/r1/$state"), 0u);
}

TEST(RefusalLogTest, MalformedDescription_LineSaysWhichMember) {
    RefusalLog refusals;
    auto bad = description("uno1");
    const auto place = bad.payload.find("\"seq\":1");
    bad.payload.replace(place, 7, "\"seq\":\"x\"");
    const auto message = bus_message("asip/servicebus/uno1/$description", bad.payload);
    const auto line = refusals.refused(message, "uno1", Refusal::kMalformed);
    ASSERT_TRUE(line);
    EXPECT_THAT(line->where, testing::HasSubstr("seq"));
    EXPECT_FALSE(refusals.refused(message, "uno1", Refusal::kMalformed)) << "once a board and reason";
    EXPECT_TRUE(refusals.refused(message, "uno1", Refusal::kTooLong));
    EXPECT_FALSE(refusals.refused(message, "uno2", Refusal::kOldSequence)) << "replays are no faults";
}

}  // namespace registry_test
}  // namespace asip::registry
