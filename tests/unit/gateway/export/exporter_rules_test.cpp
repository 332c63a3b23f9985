// SPDX-License-Identifier: Apache-2.0
// Rules of every dialect that retains what it shows: one gateway exports, no flood, nothing of an earlier
// session.
#include <gtest/gtest.h>

#include <ostream>

#include "export_world.hpp"
#include "gateway/export/homie.hpp"

namespace asip::gateway::exports {
namespace {

struct DialectRow {
    const char* name;
    std::shared_ptr<const Dialect> (*make)();
    friend void PrintTo(const DialectRow& row, std::ostream* out) { *out << row.name; }
};

const DialectRow kDialects[] = {
    {"HomeAssistant", [] { return ExportWorld::home_assistant(); }},
    {"Homie", []() -> std::shared_ptr<const Dialect> { return std::make_shared<Homie>(Homie::Options{}); }},
};

class ExporterRules : public testing::TestWithParam<DialectRow> {
  protected:
    const Dialect& dialect() const { return *dialect_; }
    std::string topic_of(std::size_t property) const {
        return dialect().state("uno1", world.boards.at("uno1").board.properties[property]);
    }
    std::string distance() const { return topic_of(0); }
    std::string servo() const { return topic_of(1); }
    /// How often each topic was published, but for the lease and what is published by the broker or says
    /// which gateway is there.
    std::map<std::string, std::size_t> sent() const {
        std::map<std::string, std::size_t> result;
        for (const auto& each : world.sent)
            if (each.topic != dialect().lease() && each.topic != dialect().sessions() &&
                each.topic != dialect().gateway_state() && each.topic.find("/$mark/") == std::string::npos)
                ++result[each.topic];
        return result;
    }
    void show_one_board() {
        world.put("uno1", exported(1));
        world.value("uno1", "distance", R"({"distance":[42]})");
        world.known("uno1", "servo/0/angle", 90);
    }

    std::shared_ptr<const Dialect> dialect_ = GetParam().make();
    ExportWorld world{1, dialect_};
};

TEST_P(ExporterRules, ValueThatIsNotKnownAnyMoreBeforeItWasSaid_IsNotSaid) {
    world.put("uno1", exported(1));
    world.start();
    world.pass(60s);
    world.room = 0;
    world.pass(1s);
    world.known("uno1", "servo/0/angle", 90);
    world.pass(1s);
    world.known("uno1", "servo/0/angle", std::nullopt);
    world.pass(1s);
    world.room = 1000000;
    world.pass(60s);
    for (const auto& each : world.sent)
        EXPECT_FALSE(each.topic == servo() && each.payload == "90");
}

TEST_P(ExporterRules, OfTwoGateways_OneExports_AndTheOtherTakesOverWithinTenSeconds_NothingIsSentTwice) {
    show_one_board();
    auto& a = world.start();
    auto& b = world.start();
    world.pass(60s);
    ASSERT_NE(a.exporter->active(), b.exporter->active());
    auto& active = a.exporter->active() ? a : b;
    auto& other = a.exporter->active() ? b : a;
    EXPECT_EQ(world.retained[distance()], "42");
    EXPECT_EQ(world.times_sent(distance()), 1u);
    EXPECT_EQ(world.times_sent(servo()), 1u);
    const auto before = sent();

    world.publish(servo() + "/set", "91");
    world.step();
    EXPECT_EQ(active.commands.size(), 1u);
    EXPECT_TRUE(other.commands.empty());
    const auto after_command = sent();

    world.kill(active);
    EXPECT_EQ(world.retained[dialect().gateway_state()], dialect().lost());
    world.pass(10s);
    EXPECT_TRUE(other.exporter->active());
    EXPECT_EQ(world.retained[dialect().gateway_state()], dialect().online());
    EXPECT_EQ(sent(), after_command) << "what is retained is still right";
    EXPECT_FALSE(before.empty());

    world.publish(servo() + "/set", "92");
    world.step();
    EXPECT_EQ(other.commands.size(), 1u);
    world.known("uno1", "servo/0/angle", 92);
    EXPECT_EQ(world.retained[servo()], "92");
}

TEST_P(ExporterRules, GatewayThatHangs_IsReplaced_AndGivesWayWhenItIsBack) {
    show_one_board();
    auto& first = world.start();
    world.pass(5s);
    ASSERT_TRUE(first.exporter->active());
    auto& second = world.start();
    world.pass(5s);
    first.alive = false;  // it is stopped: the broker keeps its connection
    world.pass(20s);
    ASSERT_TRUE(second.exporter->active());
    first.alive = true;
    world.pass(10s);
    EXPECT_NE(first.exporter->active(), second.exporter->active());
    EXPECT_EQ(world.retained[dialect().gateway_state()], dialect().online());
    EXPECT_EQ(world.times_sent(distance()), 1u);
}

TEST_P(ExporterRules, SquareWave_IsSentFiveTimesASecond_NewestLast) {
    constexpr int kChanges = 10'000;  // ten seconds
    show_one_board();
    world.start();
    world.pass(5s);
    const auto before = world.times_sent(distance());
    for (int i = 0; i < kChanges; ++i) {
        world.value("uno1", "distance", "{\"distance\":[" + std::to_string(i) + "]}");
        world.now += 1ms;
        if (i % 100 == 0) world.step();
    }
    world.pass(1s);
    const auto times = world.times_sent(distance()) - before;
    const auto seconds = std::chrono::duration<double>(kChanges * 1ms + kChanges / 100 * 100ms + 1s).count();
    EXPECT_LE(static_cast<double>(times), 5 * seconds + 1);
    EXPECT_GE(static_cast<double>(times), 4 * seconds);
    EXPECT_EQ(world.retained[distance()], std::to_string(kChanges - 1));
}

TEST_P(ExporterRules, BoardThatWasForgottenAndIsBack_IsNotShownWithOldValues) {
    show_one_board();
    world.kill(world.start());
    auto& gateway = world.start();
    world.pass(5s);
    ASSERT_EQ(world.retained[distance()], "42");
    world.kill(gateway);
    world.forget("uno1");
    world.put("uno1", exported(1));
    world.start();
    const auto before = static_cast<std::ptrdiff_t>(world.sent.size());
    world.pass(5s);
    const auto place = [&](const std::string& topic) {
        return std::find_if(world.sent.begin() + before, world.sent.end(),
                            [&](const auto& each) { return each.topic == topic; }) -
               world.sent.begin();
    };
    for (const std::size_t property : {0, 1}) {
        const auto unknown = dialect().state_text(world.boards["uno1"].board.properties[property], nullptr);
        EXPECT_EQ(world.retained[topic_of(property)], unknown);
        // Else a gateway that starts between them takes the old value for one of this session.
        EXPECT_LT(place(topic_of(property)), place(dialect().sessions()));
    }
    world.value("uno1", "distance", R"({"distance":[43]})");
    EXPECT_EQ(world.retained[distance()], "43");
}

TEST_P(ExporterRules, ConnectionIsLostBeforeOldValuesAreTakenBack_TheyAreAfterwards) {
    show_one_board();
    auto& gateway = world.start();
    world.pass(5s);
    ASSERT_EQ(world.retained[distance()], "42");
    world.kill(gateway);
    world.forget("uno1");
    world.put("uno1", exported(1));
    world.room = 0;
    world.start();
    world.pass(3s);
    ASSERT_EQ(world.retained[distance()], "42");
    world.restart_broker(true);
    world.room = 1000;
    world.pass(5s);
    for (const std::size_t property : {0, 1})
        EXPECT_EQ(world.retained[topic_of(property)],
                  dialect().state_text(world.boards["uno1"].board.properties[property], nullptr));
}

TEST_P(ExporterRules, BoardOfTheSameSession_KeepsItsValues_OverAnyNumberOfStarts) {
    show_one_board();
    auto* gateway = &world.start();
    world.pass(5s);
    // What was reported is not on the bus any more.
    world.boards["uno1"].values.clear();
    for (int i = 0; i < 5; ++i) {
        if (i % 2 == 0)
            world.kill(*gateway);
        else
            world.end(*gateway);
        gateway = &world.start();
        world.pass(15s);
        ASSERT_EQ(world.retained[distance()], "42") << "start " << i;
    }
    EXPECT_EQ(world.times_sent(distance()), 1u);
}

TEST_P(ExporterRules, SessionThatChanges_IsWrittenDown) {
    show_one_board();
    auto& gateway = world.start();
    world.pass(5s);
    world.boards["uno1"].session = "another";
    world.changed("uno1");
    world.pass(Exporter::kBetweenSessions);
    EXPECT_NE(world.retained[dialect().sessions()].find("another"), std::string::npos);
    world.forget("uno1");
    world.end(gateway);
    EXPECT_EQ(world.retained[dialect().sessions()], "{}");
}

TEST_P(ExporterRules, SessionThatChangesAmongFastValues_IsWrittenDown) {
    show_one_board();
    world.start();
    world.pass(5s);
    world.boards["uno1"].session = "another";
    world.changed("uno1");
    // At each moment one of two states waits for its turn.
    for (int i = 0; i < 300; ++i) {
        world.value("uno1", "distance", R"({"distance":[)" + std::to_string(1000 + i) + "]}");
        if (i > 0) world.known("uno1", "servo/0/angle", i % 180);
        world.pass(100ms);
    }
    EXPECT_NE(world.retained[dialect().sessions()].find("another"), std::string::npos);
}

TEST_P(ExporterRules, TopicThatSomebodyEmpties_IsThereAgainAtOnce) {
    show_one_board();
    world.put("uno2", exported(1));
    world.value("uno2", "distance", R"({"distance":[7]})");
    world.start();
    world.pass(5s);
    world.publish(servo() + "/set", "91");  // a target, where there are some
    world.step();
    const auto shown = world.retained;
    ASSERT_GE(shown.size(), 7u);
    for (const auto& [topic, payload] : shown) {
        world.publish(topic, "", true);
        world.pass(1s);
        EXPECT_EQ(world.retained[topic], payload) << topic;
    }
    for (const auto& [topic, payload] : shown)
        world.publish(topic, "", true);
    world.pass(1s);
    EXPECT_EQ(world.retained, shown) << "everything at once";
    world.publish(servo() + "/set", "92");
    world.step();
    EXPECT_EQ(world.gateways[0]->commands.size(), 2u) << "each command once";
}

TEST_P(ExporterRules, EmptiedAgainAndAgain_IsPutBackTwiceASecond_AndWhatIsNotOursNever) {
    show_one_board();
    world.start();
    world.pass(5s);
    const auto before = world.times_sent(distance());
    constexpr int kTimes = 1000;  // in ten seconds
    for (int i = 0; i < kTimes; ++i) {
        world.publish(distance(), "", true);
        world.publish(distance() + "9", "", true);
        if (i % 10 == 0) world.step();
    }
    world.pass(1s);
    EXPECT_EQ(world.retained[distance()], "42");
    EXPECT_LE(world.times_sent(distance()) - before, kTimes + 22u);
    EXPECT_FALSE(world.retained.contains(distance() + "9"));
}

TEST_P(ExporterRules, ManyTopicsEmptied_WaitForRoom) {
    for (int i = 0; i < 50; ++i) {
        const auto name = "uno" + std::to_string(i);
        world.put(name, exported(4));
        world.value(name, "distance", R"({"distance":[1,2,3,4]})");
    }
    world.start();
    world.pass(30s);
    const auto shown = world.retained;
    world.room = 20;
    for (const auto& [topic, payload] : shown)
        world.publish(topic, "", true);
    world.pass(20s);
    EXPECT_EQ(world.retained, shown);
}

TEST_P(ExporterRules, BoardThatIsForgotten_IsNotPutBack) {
    show_one_board();
    world.start();
    world.pass(5s);
    const auto topic = distance();
    world.publish(topic, "", true);
    world.forget("uno1");
    world.pass(5s);
    EXPECT_FALSE(world.retained.contains(topic));
}

TEST_P(ExporterRules, CommandsThatAreRefused_AreOneLineOfTheLogATopicAndMinute) {
    show_one_board();
    auto& gateway = world.start();
    world.pass(5s);
    gateway.log.clear();
    auto nowhere = servo();
    nowhere.replace(nowhere.rfind("servo"), 5, "other");
    for (int i = 0; i < 1000; ++i) {
        world.publish(servo() + "/set", "nonsense");
        world.publish(nowhere + "/set", "1");
        if (i % 100 == 0) world.step();
    }
    EXPECT_EQ(gateway.log.size(), 2u);
    world.pass(61s);
    ASSERT_EQ(gateway.log.size(), 4u);
    EXPECT_NE(gateway.log.back().find("(999 in a minute)"), std::string::npos) << gateway.log.back();
    world.pass(70s);
    EXPECT_EQ(gateway.log.size(), 4u);
    world.publish(servo() + "/set", "nonsense");
    world.step();
    EXPECT_EQ(gateway.log.size(), 5u);
}

INSTANTIATE_TEST_SUITE_P(Each, ExporterRules, testing::ValuesIn(kDialects),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace asip::gateway::exports
