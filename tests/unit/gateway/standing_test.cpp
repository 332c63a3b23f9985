// SPDX-License-Identifier: Apache-2.0
// How boards stand, as their agents say it, to clients that ask the gateway.
#include "api_bench.hpp"
#include "asip/property/documents.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class StandingTest : public ApiTest {
  protected:
    StandingTest() { announce(); }

    static property::Property servo() {
        property::Property servo;
        servo.id = "servo/0/angle";
        servo.kind = property::Kind::kNumber;
        servo.name = "Servo";
        servo.service = "servo";
        servo.max = 180;
        servo.write = property::Call{"servo", "write", {0, std::nullopt}};
        return servo;
    }
    static property::Property distance() {
        property::Property distance;
        distance.id = "distance/0";
        distance.name = "Distance";
        distance.service = "distance";
        distance.read = property::Place{"distance", "/distance/0"};
        return distance;
    }
    void list(std::uint64_t seq = 1, const std::string& session = "s1", const std::string& board = "uno1") {
        property::PropertyList list{{board, session, seq}, {distance(), servo()}};
        bus("asip/servicebus/" + board + "/$properties", property::to_text(list));
    }
    void values(const json& values, std::uint64_t seq = 1, const std::string& session = "s1",
                const std::string& board = "uno1", int restarts = 0) {
        json document{
            {"version", 1}, {"board", board}, {"session", session}, {"seq", seq}, {"values", values}};
        if (restarts > 0) document["restarts"] = restarts;
        bus("asip/" + board + "/$values", document.dump());
    }
    json value(const std::string& id, const std::string& board = "uno1") {
        return get("/api/boards/" + board + "/values")->body()["values"][id];
    }
    const Standing::Counters& counters() { return gateway_->mirror().standing().counters(); }
};

json set_to(const json& value) {
    return {{"value", value}, {"how", "set"}, {"age", 0.5}};
}
const json kRestart{{"unknown", "restart"}, {"age", 0}};

TEST_F(StandingTest, WithoutAList_ItIsMadeOfTheDescription_AndReportsAreShown) {
    const auto list = get("/api/boards/uno1/properties")->body();
    ASSERT_EQ(list["properties"].size(), 2u);
    EXPECT_EQ(list["properties"][0]["id"], "distance/0");
    bus("asip/uno1/distance/out", R"({"distance":[42]})");
    EXPECT_EQ(value("distance/0")["value"], 42);
    EXPECT_EQ(value("servo/0/angle")["unknown"], "never");
    EXPECT_EQ(get("/api/boards/uno1/values")->body()["present"], true);
    bus("asip/servicebus/uno1/$state", "lost");
    EXPECT_EQ(get("/api/boards/uno1/values")->body()["present"], false);
    EXPECT_EQ(value("distance/0")["value"], 42) << "the last one, of a board that is away";
}

TEST_F(StandingTest, ListThatChanges_IsAnEventWithItsBoard) {
    const auto stream = get("/api/events");
    const auto read = [&] {
        std::string out;
        stream->source->take(out, 65536);
        return out;
    };
    read();
    list();
    EXPECT_THAT(read(), testing::AllOf(HasSubstr("event: properties"), HasSubstr(R"("state":"online")")));
    list(2);
    EXPECT_EQ(read(), "") << "it is the same list";
}

TEST_F(StandingTest, Ids_ChooseAndAreChecked) {
    list();
    EXPECT_EQ(get("/api/boards/uno1/properties?ids=servo/0/angle")->body()["properties"].size(), 1u);
    EXPECT_EQ(get("/api/boards/uno1/values?ids=servo/0/angle")->body()["values"].size(), 1u);
    const auto wrong = get("/api/boards/uno1/values?ids=servo/0/angel");
    EXPECT_EQ(wrong->status(), 404);
    EXPECT_THAT(wrong->detail(), HasSubstr("did you mean"));
}

TEST_F(StandingTest, Past_IsOfNumbersThatWereReported_TheNewestFirst) {
    list();
    for (const auto* cm : {"41", "42", "43"})
        bus("asip/uno1/distance/out", std::string(R"({"distance":[)") + cm + "]}");
    EXPECT_FALSE(get("/api/boards/uno1/values")->body().contains("past"));
    const auto past = get("/api/boards/uno1/values?past=2")->body()["past"];
    ASSERT_EQ(past.size(), 1u) << past;
    ASSERT_EQ(past["distance/0"].size(), 2u);
    EXPECT_EQ(past["distance/0"][0][1], 43);
    EXPECT_EQ(past["distance/0"][1][1], 42);
    EXPECT_EQ(get("/api/boards/uno1/values?past=601")->status(), 400);
}

TEST_F(StandingTest, PutOfAValue_IsTheCommandThatSetsIt) {
    list();
    settle();
    const auto put = ask("PUT", "/api/boards/uno1/values", R"({"servo/0/angle":90})");
    ASSERT_EQ(published_.size(), 1u);
    EXPECT_EQ(published_[0].topic, "asip/uno1/servo/in");
    EXPECT_EQ(json::parse(published_[0].payload)["write"], json({0, 90}));
    answer(R"({"status":"ok","proof":"fence"})");
    EXPECT_EQ(put->status(), 204);
    const auto refused = [&](const char* body) {
        return ask("PUT", "/api/boards/uno1/values", body)->status();
    };
    EXPECT_EQ(refused(R"({"servo/7/angle":90})"), 404);
    EXPECT_EQ(refused(R"({"servo/0/angle,distance/0":90})"), 404);
    EXPECT_EQ(refused(R"({"":90})"), 404);
    EXPECT_EQ(refused(R"({"servo/0/angle":181})"), 400);
    EXPECT_EQ(refused(R"({"distance/0":5})"), 400);
    EXPECT_EQ(refused(R"({"servo/0/angle":1,"distance/0":5})"), 400);
    EXPECT_EQ(refused("7"), 400);
    EXPECT_EQ(published_.size(), 1u) << "nothing of it was sent";
}

TEST_F(StandingTest, PutOfAValueThatIsRefused_SaysWhyAndSendsNothing) {
    auto held = servo();
    held.refused = "a command made pin 9 an input";
    bus("asip/servicebus/uno1/$properties",
        property::to_text(property::PropertyList{{"uno1", "s1", 1}, {distance(), held}}));
    settle();
    const auto put = ask("PUT", "/api/boards/uno1/values", R"({"servo/0/angle":90})");
    EXPECT_EQ(put->status(), 409);
    EXPECT_EQ(put->detail(), "a command made pin 9 an input");
    EXPECT_TRUE(published_.empty());
    list(2);
    EXPECT_EQ(ask("PUT", "/api/boards/uno1/values", R"({"servo/0/angle":90})")->status(), 0)
        << "it is on its way";
    EXPECT_EQ(published_.size(), 1u);
}

TEST_F(StandingTest, ReportedValue_CountsOverWhatTheAgentSays_UntilARestart) {
    list();
    values({{"distance/0", {{"value", 1}, {"how", "reported"}, {"age", 9}}}});
    EXPECT_EQ(value("distance/0")["value"], 1);
    bus("asip/uno1/distance/out", R"({"distance":[42]})");
    EXPECT_EQ(value("distance/0")["value"], 42);
    values({{"distance/0", {{"value", 41}, {"how", "reported"}, {"age", 0.1}}}}, 2);
    EXPECT_EQ(value("distance/0")["value"], 42) << "no view goes back to an older value";
    values({{"distance/0", kRestart}}, 3, "s1", "uno1", 1);
    EXPECT_EQ(value("distance/0")["unknown"], "restart");
    bus("asip/uno1/distance/out", R"({"distance":[7]})");
    EXPECT_EQ(value("distance/0")["value"], 7);
}

TEST_F(StandingTest, DamagedDocuments_AreDroppedAndCounted_AndTheNextOneWorks) {
    list();
    values({{"servo/0/angle", set_to(90)}});
    const auto topic = "asip/servicebus/uno1/$properties";
    for (const auto& text : {std::string("{"), std::string("[]"), std::string(200'000, ' '),
                             std::string(R"({"version":2,"board":"uno1","session":"s1","seq":9})")})
        bus(topic, text);
    property::PropertyList other{{"another", "s1", 9}, {servo()}};
    bus(topic, property::to_text(other));
    bus("asip/uno1/$values", "7");
    EXPECT_EQ(counters().damaged, 6u);
    EXPECT_EQ(value("servo/0/angle")["value"], 90);
    values({{"servo/0/angle", set_to(91)}}, 2);
    EXPECT_EQ(value("servo/0/angle")["value"], 91);
}

TEST_F(StandingTest, OfAnotherSessionThanTheDescription_ItIsNotKnown) {
    list(1, "s2");
    values({{"servo/0/angle", set_to(90)}}, 1, "s2");
    EXPECT_EQ(value("servo/0/angle")["unknown"], "never");
    bus("asip/servicebus/uno1/$description",
        R"({"board":"uno1","session":"s2","seq":1,"lease":60,"services":[)"
        R"({"name":"servo","id":"S","model":"servo@1","title":"Servos"}]})");
    EXPECT_EQ(value("servo/0/angle")["value"], 90) << "the description came behind them";
}

TEST_F(StandingTest, BeforeItsBoardWhileTheRetainedCome_IsKept) {
    gateway_->disconnected();
    list(1, "s1", "late");
    gateway_->subscribed();
    values({{"servo/0/angle", set_to(1)}}, 1, "s1", "late");
    list(1, "s1", "nobody");
    announce("late");
    settle();
    EXPECT_EQ(value("servo/0/angle", "late")["value"], 1);
    EXPECT_EQ(gateway_->mirror().standing().size(), 1u);
    list(1, "s1", "nobody");
    EXPECT_EQ(gateway_->mirror().standing().size(), 1u) << "of no board";
}

TEST_F(StandingTest, ClearedWhileTheBrokerWasAway_IsNotKnown) {
    list();
    values({{"servo/0/angle", set_to(90)}});
    gateway_->disconnected();
    gateway_->subscribed();
    settle();
    EXPECT_EQ(value("servo/0/angle")["unknown"], "never");
    bus("asip/servicebus/uno1/$state", "lost");
}

TEST_F(StandingTest, Stream_BeginsWithAll_AndTellsEachChange) {
    list();
    values({{"servo/0/angle", set_to(90)}});
    const auto stream = get("/api/boards/uno1/values/stream");
    ASSERT_TRUE(stream->source);
    const auto read = [&] {
        std::string out;
        stream->source->take(out, 65536);
        return out;
    };
    const auto first = read();
    EXPECT_THAT(first, HasSubstr("event: values\ndata: {"));
    EXPECT_THAT(first, HasSubstr(R"("servo/0/angle":{"age":0.5,"how":"set","value":90})"));
    EXPECT_THAT(first, HasSubstr("event: snapshot-end"));
    bus("asip/uno1/distance/out", R"({"distance":[42]})");
    const auto report = read();
    EXPECT_THAT(report, HasSubstr(R"("distance/0":{"age":0,"how":"reported","value":42})"));
    EXPECT_THAT(report, testing::Not(HasSubstr("servo/0")));
    values({{"servo/0/angle", set_to(91)}}, 2);
    EXPECT_THAT(read(), HasSubstr(R"("value":91)"));
    values({{"servo/0/angle", set_to(91)}}, 3);
    EXPECT_EQ(read(), "") << "it stands as before";
    property::PropertyList other{{"uno1", "s1", 2}, {distance()}};
    bus("asip/servicebus/uno1/$properties", property::to_text(other));
    const auto changed = read();
    EXPECT_THAT(changed, HasSubstr("event: properties\ndata: {\"board\":\"uno1\"}"));
    EXPECT_THAT(changed, testing::Not(HasSubstr("servo/0")));
}

std::string button(std::uint64_t seq, const std::string& events, const std::string& session = "s1") {
    return R"({"version":1,"board":"uno1","session":")" + session + R"(","seq":)" + std::to_string(seq) +
           R"(,"values":{"io/2":{"value":true,"how":"reported","age":0,"events":)" + events + "}}}";
}

TEST(StandingOfAButton, EachEventIsTakenOnce_AndNoneOfAnEarlierTime) {
    using enum property::ButtonAct;
    Standing standing;
    const auto acts = [&](const std::string& text, bool stored = false) {
        std::vector<property::ButtonAct> result;
        for (const auto& [id, act] : standing.take_values("uno1", text, "", Time{1s}, stored).acts)
            result.push_back(act);
        return result;
    };
    EXPECT_THAT(acts(button(1, R"([[4,"press"]])"), true), testing::IsEmpty()) << "the broker kept it";
    EXPECT_THAT(acts(button(2, R"([[4,"press"],[6,"double"],[5,"release"]])")),
                testing::ElementsAre(kRelease, kDouble));
    EXPECT_THAT(acts(button(3, R"([[5,"release"],[6,"double"]])")), testing::IsEmpty());
    EXPECT_THAT(acts(button(3, R"([[7,"hold"]])")), testing::ElementsAre(kHold));
    EXPECT_THAT(acts(button(2, R"([[8,"press"]])")), testing::IsEmpty()) << "an older document";
    EXPECT_THAT(acts(button(1, R"([[1,"press"]])", "s2")), testing::ElementsAre(kPress))
        << "numbers begin anew";
    EXPECT_THAT(acts(""), testing::IsEmpty());
    EXPECT_THAT(acts(button(2, R"([[1,"press"]])", "s2")), testing::IsEmpty()) << "it was cleared meanwhile";
    standing.reading();
    standing.complete([](const std::string&) { return true; });
    EXPECT_THAT(acts(button(3, R"([[1,"press"],[2,"hold"]])", "s2")), testing::ElementsAre(kHold))
        << "the broker came back without it";
}

}  // namespace
}  // namespace asip::gateway
