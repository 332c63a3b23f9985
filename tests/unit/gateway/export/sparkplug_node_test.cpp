// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/sparkplug_node.hpp"

#include <gmock/gmock.h>

#include <random>

#include "sparkplug_host.hpp"

namespace asip::gateway::exports {
namespace {

using namespace std::string_literals;
using sparkplug::DataType;
using sparkplug::Metric;
using sparkplug::Payload;
using sparkplug::Value;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const Value kNull;
// Values of the property "Quality", as Int32.
const std::string kBadQuality = "\x12\x04\x08\x03\x18\x00"s;
const std::string kGoodQuality = "\x12\x05\x08\x03\x18\xc0\x01"s;
Value whole(std::int64_t value) {
    return value;
}

class SparkplugWorld : public ExportWorld {
  public:
    explicit SparkplugWorld(std::uint64_t seed = 1) : ExportWorld(seed) {}

    Gateway& start_node(SparkplugNode::Options options = {}) {
        options.dialect.group = "plant";
        options.gateway = "gw" + std::to_string(gateways.size() + 1);
        if (options.host.empty()) options.host = "machine";
        return start([options](Random random, Export::Port port) {
            return std::make_unique<SparkplugNode>(options, std::move(random), std::move(port));
        });
    }
    static SparkplugNode::Options read_only() {
        SparkplugNode::Options options;
        options.dialect.read_only = true;
        return options;
    }
    static const SparkplugNode& node(const Gateway& gateway) {
        return dynamic_cast<const SparkplugNode&>(*gateway.exporter);
    }
    SparkplugHost& view() {
        host.follow(*this);
        return host;
    }
    void ask(const std::string& kind, const std::string& end, const std::string& name, Value value,
             std::optional<std::uint64_t> alias = {}) {
        Payload payload;
        Metric metric;
        metric.name = name;
        metric.alias = alias;
        metric.value = std::move(value);
        payload.metrics.push_back(std::move(metric));
        publish("spBv1.0/plant/" + kind + "/asip" + end, sparkplug::write(payload));
    }
    void set(const std::string& board, const std::string& name, Value value) {
        ask("DCMD", "/" + board, name, std::move(value));
        step();
    }
    void rebirth() { ask("NCMD", "", "Node Control/Rebirth", true); }

    SparkplugHost host;
};

class SparkplugNodeTest : public testing::Test {
  protected:
    SparkplugNodeTest() { world.put("uno1", exported(2)); }
    ~SparkplugNodeTest() override {
        EXPECT_THAT(world.view().faults, IsEmpty());
        world.retained.erase("spBv1.0/STATE/scada");
        for (const auto& [topic, payload] : world.retained)
            EXPECT_THAT(topic, testing::StartsWith("asip/export/sparkplug/$"));
    }
    ExportWorld::Gateway& active() {
        auto& gateway = world.start_node();
        world.pass(3s);
        return gateway;
    }
    /// A node that waits for this primary host.
    void start_for_scada() {
        SparkplugNode::Options options;
        options.dialect.host = "scada";
        world.start_node(options);
        world.pass(3s);
    }
    void scada_says(bool online, std::int64_t time) {
        world.publish(
            "spBv1.0/STATE/scada",
            R"({"online":)"s + (online ? "true" : "false") + R"(,"timestamp":)" + std::to_string(time) + "}",
            true);
        world.pass(3s);
    }
    SparkplugWorld world;
};

TEST_F(SparkplugNodeTest, GatewayAndBoardsAreBorn_WithNamesUnitsAndWhatIsKnown) {
    auto board = exported(2);
    board.properties[0].unit = "cm";
    board.properties[0].max = 400;
    for (auto& each : {strip_of_pixels(), stop_button()})
        board.properties.push_back(each);
    world.put("uno1", board);
    world.value("uno1", "distance", R"({"distance":[42.5]})");
    world.boards["uno2"] = {false, exported(1), "1", {}, {}};  // it is lost
    active();
    auto& host = world.view();
    EXPECT_TRUE(host.node_alive);
    EXPECT_THAT(host.bd_seqs, ElementsAre(0u));
    ASSERT_EQ(host.devices.size(), 1u);
    EXPECT_EQ(host.value("uno1", "distance/0"), Value(42.5));
    EXPECT_EQ(host.value("uno1", "distance/1"), kNull);
    EXPECT_EQ(host.value("uno1", "servo/0/angle"), kNull);
    EXPECT_EQ(host.value("uno1", "pixels/light/on"), kNull);
    EXPECT_EQ(host.value("uno1", "motors/stop"), Value(false));
    EXPECT_EQ(host.metric("uno1", "distance/0")->type, DataType::kDouble);
    EXPECT_EQ(host.metric("uno1", "servo/0/angle")->type, DataType::kInt64);
    EXPECT_EQ(host.metric("uno1", "pixels/light/color")->type, DataType::kString);
}

TEST(Sparkplug, PropertiesSayUnitRangeAndWhatIsReadOnly) {
    const auto board = exported(1);
    auto distance = board.properties[0];
    distance.unit = "cm";
    Sparkplug::Options options;
    const auto of = [&](const Property& property) {
        return Sparkplug(options).properties(property, Sparkplug::slots(property).front());
    };
    using sparkplug::Property;
    EXPECT_THAT(of(distance), ElementsAre(Property{"name", "Distance 0"s}, Property{"engUnit", "cm"s},
                                          Property{"readOnly", true}));
    EXPECT_THAT(of(board.properties[1]),
                ElementsAre(Property{"name", "Servo angle"s}, Property{"engLow", 0.0},
                            Property{"engHigh", 180.0}, Property{"readOnly", false}));
    options.read_only = true;
    EXPECT_THAT(of(board.properties[1]), Contains(Property{"readOnly", true}));
}

TEST(Sparkplug, NamesThatCannotBeLevelsOfATopic_AreRefused) {
    for (const auto* good : {"plant", "Line-2", "a.b"})
        EXPECT_TRUE(Sparkplug::valid_id(good)) << good;
    for (const auto* bad : {"", "a/b", "+", "a#", "a b", "\xc3\xa4"})
        EXPECT_FALSE(Sparkplug::valid_id(bad)) << bad;
}

TEST_F(SparkplugNodeTest, ValuesAreSaidByAlias_OnceForAllOfAService_AndSeqWraps) {
    active();
    for (int i = 0; i < 700; ++i) {
        world.value("uno1", "distance",
                    R"({"distance":[)" + std::to_string(i) + "," + std::to_string(-i) + "]}");
        world.pass(300ms);
    }
    auto& host = world.view();
    EXPECT_EQ(host.value("uno1", "distance/0"), Value(699.0));
    EXPECT_EQ(host.value("uno1", "distance/1"), Value(-699.0));
    EXPECT_GT(host.messages, 600u);
    EXPECT_EQ(host.data["uno1"], 700);
    EXPECT_EQ(host.births["uno1"], 1);
}

TEST_F(SparkplugNodeTest, ValueThatCannotBeKnownAnyMore_IsNull) {
    active();
    world.known("uno1", "servo/0/angle", 90);
    EXPECT_EQ(world.view().value("uno1", "servo/0/angle"), whole(90));
    world.pass(1s);
    world.known("uno1", "servo/0/angle", std::nullopt);
    EXPECT_EQ(world.view().value("uno1", "servo/0/angle"), kNull);
}

TEST_F(SparkplugNodeTest, BoardThatIsLost_Dies_AndIsBornAgain_WithoutWhatWasSet) {
    active();
    world.known("uno1", "servo/0/angle", 90);
    world.boards["uno1"].there = false;
    world.boards["uno1"].known.clear();
    world.changed("uno1");
    world.pass(1s);
    EXPECT_THAT(world.view().devices, IsEmpty());
    EXPECT_EQ(world.host.deaths["uno1"], 1);
    world.value("uno1", "distance", R"({"distance":[7]})");  // late
    world.boards["uno1"].there = true;
    world.changed("uno1");
    world.pass(1s);
    EXPECT_EQ(world.view().births["uno1"], 2);
    EXPECT_EQ(world.host.value("uno1", "distance/0"), Value(7.0));
    EXPECT_EQ(world.host.value("uno1", "servo/0/angle"), kNull);
}

TEST_F(SparkplugNodeTest, BoardWithAnotherSession_IsBornAgain_WithoutWhatWasSet) {
    active();
    world.known("uno1", "servo/0/angle", 90);
    world.boards["uno1"].session = "another";
    world.boards["uno1"].known.clear();
    world.changed("uno1");
    EXPECT_EQ(world.view().births["uno1"], 2);
    EXPECT_EQ(world.host.value("uno1", "servo/0/angle"), kNull);
}

TEST_F(SparkplugNodeTest, BoardThatChanges_IsBornAgain_WithAliasesThatNoHostHasSeen) {
    auto& gateway = active();
    const auto alias = world.view().metric("uno1", "servo/0/angle")->alias;
    world.put("uno1", exported(0));
    world.put("uno2", exported(1));
    world.pass(1s);
    EXPECT_NE(world.view().metric("uno1", "servo/0/angle")->alias, alias);
    world.ask("DCMD", "/uno1", "", whole(90), alias);  // of before
    world.step();
    EXPECT_THAT(gateway.commands, IsEmpty());
    EXPECT_EQ(world.host.metric("uno1", "distance/0"), nullptr);
    world.forget("uno1");
    world.pass(1s);
    EXPECT_EQ(world.view().deaths["uno1"], 1);
    EXPECT_EQ(world.host.devices.size(), 1u);
}

TEST_F(SparkplugNodeTest, HostAsksForBirths_AndGetsThem_OnceASecond) {
    active();
    world.value("uno1", "distance", R"({"distance":[5]})");
    const auto before = world.view().bd_seqs.size();
    for (int i = 0; i < 50; ++i)
        world.rebirth();
    world.pass(300ms);
    EXPECT_EQ(world.view().bd_seqs.size(), before + 1);
    world.pass(3s);
    EXPECT_EQ(world.view().bd_seqs.size(), before + 2);
    EXPECT_THAT(world.host.bd_seqs, testing::Each(0u));  // it is the same connection
    EXPECT_EQ(world.host.value("uno1", "distance/0"), Value(5.0));
    world.ask("NCMD", "", "Node Control/Rebirth", false);
    world.pass(3s);
    EXPECT_EQ(world.view().bd_seqs.size(), before + 2);
}

TEST_F(SparkplugNodeTest, Command_IsSentToTheBoard_AndItsMetricFollowsTheProof) {
    auto& gateway = active();
    world.set("uno1", "servo/0/angle", whole(90));
    ASSERT_EQ(gateway.commands.size(), 1u);
    EXPECT_EQ(gateway.commands[0].second.payload, R"({"write":[0,90]})");
    EXPECT_EQ(world.view().value("uno1", "servo/0/angle"), kNull);
    world.known("uno1", "servo/0/angle", 90);
    gateway.answers[0]("");
    world.pass(1s);
    EXPECT_EQ(world.view().value("uno1", "servo/0/angle"), whole(90));
    EXPECT_THAT(world.host.devices["uno1"].bytes, Not(HasSubstr("Quality")));
    // By alias, and with a fraction that is none.
    world.ask("DCMD", "/uno1", "", Value(45.0), world.host.metric("uno1", "servo/0/angle")->alias);
    world.step();
    ASSERT_EQ(gateway.commands.size(), 2u);
    EXPECT_EQ(gateway.commands[1].second.payload, R"({"write":[0,45]})");
}

TEST_F(SparkplugNodeTest, CommandThatFails_LeavesTheValue_AndMarksItsQuality_UntilOneSucceeds) {
    auto& gateway = active();
    world.known("uno1", "servo/0/angle", 90);
    world.set("uno1", "servo/0/angle", whole(200));
    world.pass(1s);
    EXPECT_THAT(gateway.commands, IsEmpty());
    const auto said = [&] { return world.view().devices["uno1"].bytes; };
    EXPECT_EQ(world.view().value("uno1", "servo/0/angle"), whole(90));
    EXPECT_THAT(said(), AllOf(HasSubstr("Quality"), HasSubstr(kBadQuality),
                              HasSubstr("Servo angle cannot be set to 200")));
    world.rebirth();
    world.pass(2s);
    EXPECT_THAT(said(), HasSubstr(kBadQuality));
    world.set("uno1", "servo/0/angle", whole(91));
    gateway.answers[0]("no servo");
    world.pass(1s);
    EXPECT_THAT(said(), AllOf(HasSubstr(kBadQuality), HasSubstr("Servo angle: no servo")));
    world.set("uno1", "servo/0/angle", whole(92));
    gateway.answers[1]("");
    world.pass(1s);
    EXPECT_THAT(said(), AllOf(HasSubstr(kGoodQuality), Not(HasSubstr("error"))));
}

TEST_F(SparkplugNodeTest, CommandThatThePropertyRefuses_IsAnsweredAndNotSent) {
    auto board = exported(2);
    for (auto& each : board.properties)
        each.refused = each.settable() ? "a command made pin 9 an input" : "";
    world.put("uno1", board);
    auto& gateway = active();
    world.set("uno1", "servo/0/angle", whole(90));
    world.pass(1s);
    EXPECT_THAT(gateway.commands, IsEmpty());
    EXPECT_THAT(world.view().devices["uno1"].bytes,
                AllOf(HasSubstr(kBadQuality), HasSubstr("a command made pin 9 an input")));
}

TEST_F(SparkplugNodeTest, FloodOfCommandsThatFail_IsNoFloodOfData) {
    active();
    const auto before = world.view().data["uno1"];
    for (int i = 0; i < 1000; ++i) {
        world.ask("DCMD", "/uno1", "servo/0/angle", whole(1000 + i));
        if (i % 100 == 99) world.step();
    }
    world.pass(1s);
    EXPECT_LE(world.view().data["uno1"] - before, 12);
}

TEST_F(SparkplugNodeTest, LightIsSetByItsParts_AndKeepsTheOthers) {
    auto board = exported(0, false);
    board.properties.push_back(strip_of_pixels());
    world.put("uno1", board);
    auto& gateway = active();
    world.known("uno1", "pixels/light", {{{"on", true}, {"brightness", 100}, {"color", 255}}});
    EXPECT_EQ(world.view().value("uno1", "pixels/light/on"), Value(true));
    EXPECT_EQ(world.host.value("uno1", "pixels/light/brightness"), whole(100));
    EXPECT_EQ(world.host.value("uno1", "pixels/light/color"), Value("#0000ff"s));
    const auto payloads = [&] {
        std::vector<std::string> result;
        for (const auto& [name, request] : std::exchange(gateway.commands, {}))
            result.push_back(request.payload);
        return result;
    };
    world.set("uno1", "pixels/light/color", "#ff0000"s);
    EXPECT_THAT(payloads(), ElementsAre(R"({"fill":[16711680]})", R"({"brightness":[100]})"));
    world.set("uno1", "pixels/light/brightness", whole(20));
    EXPECT_THAT(payloads(), ElementsAre(R"({"brightness":[20]})"));
    world.set("uno1", "pixels/light/brightness", whole(0));
    EXPECT_THAT(payloads(), ElementsAre(R"({"brightness":[0]})"));
    world.set("uno1", "pixels/light/on", false);
    EXPECT_THAT(payloads(), ElementsAre(R"({"brightness":[0]})"));
    for (const auto& [name, bad] :
         {std::pair("pixels/light/color", Value("red"s)), std::pair("pixels/light/on", whole(1)),
          std::pair("pixels/light/brightness", whole(256)),
          std::pair("pixels/light/brightness", Value(std::numeric_limits<double>::quiet_NaN()))}) {
        world.set("uno1", name, bad);
        EXPECT_THAT(payloads(), IsEmpty()) << name;
    }
}

TEST_F(SparkplugNodeTest, ButtonIsPressedByTrueAlone) {
    auto board = exported(0, false);
    board.properties.push_back(stop_button());
    world.put("uno1", board);
    auto& gateway = active();
    world.set("uno1", "motors/stop", false);
    EXPECT_THAT(gateway.commands, IsEmpty());
    world.set("uno1", "motors/stop", true);
    ASSERT_EQ(gateway.commands.size(), 1u);
    EXPECT_EQ(gateway.commands[0].second.payload, R"({"stop":[]})");
}

TEST_F(SparkplugNodeTest, WhatIsNoCommand_IsCountedAndDropped_AndTheNextOneWorks) {
    auto& gateway = active();
    const auto good = [] {
        Payload payload;
        Metric metric;
        metric.name = "servo/0/angle";
        metric.value = std::int64_t{90};
        payload.metrics.push_back(metric);
        return sparkplug::write(payload);
    }();
    const std::string topic = "spBv1.0/plant/DCMD/asip/uno1";
    std::uint64_t bad = 0;
    for (const auto& payload : {"90"s, good.substr(0, good.size() - 1), good + "\x12",
                                std::string(300'000, 'x'), "\x12\xff\xff\xff\xff\x7f"s, "{}"s}) {
        world.publish(topic, payload);
        world.publish("spBv1.0/plant/NCMD/asip", payload);
        bad += 2;
    }
    world.step();
    EXPECT_EQ(world.node(gateway).counters().bad, bad);
    world.set("uno1", "nothing", whole(1));
    world.set("nobody", "servo/0/angle", whole(1));
    world.ask("DCMD", "/uno1", "", whole(1), 999);
    world.ask("NCMD", "", "Node Control/Reboot", true);
    world.publish(topic, "");
    world.publish(topic, good, true);  // a client retained it: it comes again and again
    world.retained.erase(topic);
    world.step();
    EXPECT_EQ(world.node(gateway).counters().unknown, 4u);
    EXPECT_LE(gateway.log.size(), 12u);
    EXPECT_THAT(gateway.log, Contains(HasSubstr("DCMD/asip/uno1 is dropped: it is no")));
    gateway.commands.clear();
    world.publish(topic, good);
    world.step();
    EXPECT_EQ(gateway.commands.size(), 1u);
    world.set("uno1", "distance/0", whole(1));
    world.set("uno1", "servo/0/angle", kNull);
    EXPECT_EQ(gateway.commands.size(), 1u);
}

TEST_F(SparkplugNodeTest, ReadOnly_NothingIsSet_ButBirthsAreGiven) {
    auto& gateway = world.start_node(SparkplugWorld::read_only());
    world.pass(3s);
    world.set("uno1", "servo/0/angle", whole(90));
    EXPECT_THAT(gateway.commands, IsEmpty());
    world.rebirth();
    world.pass(2s);
    EXPECT_EQ(world.view().bd_seqs.size(), 2u);
}

TEST_F(SparkplugNodeTest, GatewayThatIsKilled_DiesByItsWill_WithTheNumberOfItsBirth) {
    auto& gateway = active();
    EXPECT_EQ(gateway.will->topic, "spBv1.0/plant/NDEATH/asip");
    EXPECT_EQ(gateway.will->qos, 1);
    EXPECT_FALSE(gateway.will->retain);
    world.kill(gateway);
    EXPECT_FALSE(world.view().node_alive);
    world.start_node();
    world.pass(12s);
    EXPECT_TRUE(world.view().node_alive);
    EXPECT_THAT(world.host.bd_seqs, ElementsAre(0u, 1u));
}

TEST_F(SparkplugNodeTest, BrokerThatRestarts_GetsBirths_WithTheNextNumber_AsItsWillHas) {
    auto& gateway = active();
    for (unsigned i = 1; i < 300; ++i) {
        world.restart_broker(true);
        world.pass(300ms);
        ASSERT_EQ(world.view().bd_seqs.back(), i % 256);
    }
    world.kill(gateway);
    EXPECT_FALSE(world.view().node_alive);
}

TEST_F(SparkplugNodeTest, GatewayThatEnds_SaysSo_AndTheNextOneFollowsAtOnce) {
    auto& gateway = active();
    world.end(gateway);
    EXPECT_FALSE(world.view().node_alive);
    world.start_node();
    world.pass(3s);
    EXPECT_THAT(world.view().bd_seqs, ElementsAre(0u, 1u));
}

TEST_F(SparkplugNodeTest, DeathOfThisSession_ThatSomebodySays_IsAnsweredByBirths) {
    auto& gateway = active();
    world.publish(*gateway.will);
    world.pass(3s);
    EXPECT_TRUE(world.view().node_alive);
    EXPECT_EQ(world.host.bd_seqs.size(), 2u);
}

TEST_F(SparkplugNodeTest, PrimaryHost_IsWaitedFor_AndLeftWhenItGoes) {
    start_for_scada();
    EXPECT_FALSE(world.view().node_alive);
    world.publish("spBv1.0/STATE/scada", "ONLINE");  // no JSON
    scada_says(true, 10);
    EXPECT_TRUE(world.view().node_alive);
    scada_says(false, 9);  // the will of an earlier connection of the host
    EXPECT_TRUE(world.view().node_alive);
    scada_says(false, 10);
    EXPECT_FALSE(world.view().node_alive);
    scada_says(true, 20);
    EXPECT_TRUE(world.view().node_alive);
    EXPECT_THAT(world.host.bd_seqs, ElementsAre(0u, 1u));
}

TEST_F(SparkplugNodeTest, StateOfAHostWithATimeOfTheFuture_IsNotTheLatestForEver) {
    scada_says(false, 9000000000000000);
    start_for_scada();
    EXPECT_FALSE(world.view().node_alive);
    scada_says(true, 1000);
    EXPECT_TRUE(world.view().node_alive) << "what is retained does not bind it";
    scada_says(false, 9000000000000000);
    EXPECT_FALSE(world.view().node_alive);
    scada_says(true, 2000);
    EXPECT_TRUE(world.view().node_alive) << "nor does what was said live";
    scada_says(false, 1999);
    EXPECT_TRUE(world.view().node_alive);
}

TEST_F(SparkplugNodeTest, RetainedStateOfAHost_DoesNotBindWhatItSaysLive) {
    scada_says(false, 60'000);  // within what clocks may differ
    start_for_scada();
    scada_says(true, 2000);
    EXPECT_TRUE(world.view().node_alive);
}

TEST_F(SparkplugNodeTest, SlowBroker_GetsBirthsInPieces_AndDataOnlyBehindThem) {
    for (int i = 0; i < 200; ++i)
        world.put("b" + std::to_string(i), exported(3));
    world.room = 7;
    world.start_node();
    for (int i = 0; i < 100; ++i) {
        world.value("b199", "distance", R"({"distance":[)" + std::to_string(i) + "]}");
        world.step();
    }
    EXPECT_EQ(world.view().devices.size(), 201u);
    world.pass(1s);
    EXPECT_EQ(world.view().value("b199", "distance/0"), Value(99.0));
}

TEST_F(SparkplugNodeTest, OptionThatIsTakenAway_AndClean_LeaveNothing) {
    world.kill(active());
    EXPECT_FALSE(world.retained.empty());
    SparkplugNode::Options options;
    options.enabled = false;
    options.host = "other machine";
    auto& elsewhere = world.start_node(options);
    world.pass(15s);
    EXPECT_FALSE(world.retained.empty());
    EXPECT_FALSE(elsewhere.exporter->will()) << "it is no edge node";
    world.kill(elsewhere);
    options.host = "machine";
    auto& here = world.start_node(options);
    world.pass(15s);
    EXPECT_THAT(world.retained, IsEmpty());
    EXPECT_TRUE(here.exporter->finished());
    options.clear_all = true;
    auto& clean = world.start_node(options);
    world.pass(3s);
    EXPECT_TRUE(clean.exporter->finished());
}

/// Whatever happened: hosts see the boards that are there, with their newest values, and no message breaks a
/// rule.
TEST(SparkplugHistory, RandomSequences_LeaveTheHostWithTheTruth) {
    for (unsigned seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        const auto pick = [&](unsigned below) { return random() % below; };
        SparkplugWorld world(seed);
        for (int i = 0; i < 30; ++i) {
            const auto board = "uno" + std::to_string(pick(4));
            switch (pick(9)) {
                case 0:
                    if (world.gateways.size() < 12) world.start_node();
                    break;
                case 1:
                    if (!world.gateways.empty()) world.kill(*world.gateways[pick(world.gateways.size())]);
                    break;
                case 2:
                    if (!world.gateways.empty())
                        if (auto& gateway = *world.gateways[pick(world.gateways.size())]; gateway.alive)
                            world.end(gateway);
                    break;
                case 3:
                    world.restart_broker(pick(2) == 0);
                    break;
                case 4:
                    world.forget(board);
                    break;
                case 5:
                    world.rebirth();
                    break;
                case 6:
                    if (world.boards.contains(board)) {
                        world.boards[board].there = pick(2) == 0;
                        world.changed(board);
                    }
                    break;
                case 7:
                    if (world.boards.contains(board))
                        world.value(board, "distance",
                                    "{\"distance\":[" + std::to_string(pick(9)) + ",1,2]}");
                    break;
                default:
                    world.put(board, exported(static_cast<int>(pick(4)), pick(2) == 0));
            }
            world.room = pick(3) == 0 ? 1 + pick(5) : 1000;
            for (auto steps = pick(40); steps > 0; --steps)
                world.step();
        }
        world.room = 1000;
        world.start_node();
        world.pass(20s);
        auto& host = world.view();
        EXPECT_THAT(host.faults, IsEmpty());
        EXPECT_TRUE(host.node_alive);
        std::size_t there = 0;
        for (const auto& [name, board] : world.boards) {
            if (!board.there) continue;
            ++there;
            ASSERT_TRUE(host.devices.contains(name)) << name;
            EXPECT_EQ(host.devices[name].metrics.size(), board.board.properties.size());
            if (board.board.property("distance-0") == nullptr || !board.values.contains("distance")) continue;
            const auto value =
                nlohmann::json::parse(board.values.at("distance"))["distance"][0].get<double>();
            EXPECT_EQ(host.value(name, "distance/0"), Value(value));
        }
        EXPECT_EQ(host.devices.size(), there);
        if (testing::Test::HasFailure()) return;
    }
}

}  // namespace
}  // namespace asip::gateway::exports
