// SPDX-License-Identifier: Apache-2.0
#include "asip/links/sources.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace asip::links {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

/// A board with a button at pin 2 and an input at pin 3.
class SourcesTest : public testing::Test {
  protected:
    bus::Topics topics;
    Sources sources{topics, "lamp", "links", [] { return std::uint64_t{7}; }};
    Time now{};

    void SetUp() override {
        sources.want({{"desk", "io/2"}, {"desk", "io/3"}}, now);
        sources.connected(now);
    }
    std::vector<std::string> hear(const std::string& topic, const std::string& payload,
                                  bool retained = false) {
        mqtt::Message message{.topic = topic, .payload = payload, .retain = retained};
        return words(sources.take(message, now));
    }
    static std::vector<std::string> words(const Sources::Tolds& tolds) {
        std::vector<std::string> result;
        for (const auto& told : tolds) {
            if (told.kind == Told::Kind::kPresent) result.push_back(told.is ? "there" : "gone");
            if (told.kind == Told::Kind::kAct)
                result.push_back(told.id + " " + std::string(to_text(told.act)));
            if (told.kind == Told::Kind::kValue)
                result.push_back(told.id + " " + (told.value ? told.value->dump() : "?"));
        }
        return result;
    }
    std::vector<std::string> list(const std::string& session = "a") {
        property::PropertyList made;
        made.head = {"desk", session, 1};
        for (const int number : {2, 3}) {
            property::Property property;
            property.id = "io/" + std::to_string(number);
            property.kind = property::Kind::kBinarySensor;
            property.name = "pin";
            property.service = "io";
            property.choices = {{"off", 0}, {"on", 1}};
            property.read = property::Place{"io", "/digital/" + std::to_string(number), false};
            if (number == 2) property.meaning.klass = "button";
            made.properties.push_back(property);
        }
        return hear(topics.properties("desk"), property::to_text(made));
    }
    std::vector<std::string> values(std::uint64_t seq, std::map<std::string, bool> known,
                                    std::vector<property::ButtonEvent> events = {}, bool retained = false,
                                    const std::string& session = "a") {
        property::ValueDocument document;
        document.head = {"desk", session, seq};
        document.clock = "x-1";
        for (const auto& [id, value] : known) {
            property::ShownValue shown;
            shown.value = value;
            shown.how = property::How::kReported;
            if (id == "io/2") shown.events = events;
            document.values[id] = shown;
        }
        return hear(topics.values("desk"), property::to_text(document), retained);
    }
    std::vector<std::string> state(const std::string& word, bool retained = false) {
        return hear(topics.state("desk"), word, retained);
    }
    static constexpr auto kPress = property::ButtonAct::kPress;
};

TEST_F(SourcesTest, Retained_InAnyOrderIsHowItStands) {
    EXPECT_THAT(values(5, {{"io/2", true}, {"io/3", false}}, {{3, kPress}}, true), IsEmpty());
    EXPECT_THAT(state("online"), ElementsAre("there"));
    EXPECT_THAT(list(), ElementsAre("io/2 true", "io/3 false"));
}

TEST_F(SourcesTest, Acts_EachOnceAndNoneOfBefore) {
    state("online");
    list();
    values(5, {{"io/2", false}}, {{3, kPress}}, true);
    EXPECT_THAT(values(6, {{"io/2", true}}, {{3, kPress}, {4, kPress}}),
                ElementsAre("io/2 press", "io/2 true"));
    EXPECT_THAT(values(6, {{"io/2", true}}, {{3, kPress}, {4, kPress}}), IsEmpty()) << "QoS 1 repeats";
    EXPECT_THAT(values(7, {{"io/2", true}}, {{4, kPress}}), IsEmpty());
    EXPECT_THAT(values(1, {{"io/2", true}}, {{1, kPress}}, false, "b"), IsEmpty()) << "another session";
    EXPECT_THAT(values(2, {{"io/2", true}}, {{1, kPress}, {2, kPress}}, false, "b"),
                ElementsAre("io/2 press"));
}

TEST_F(SourcesTest, Inputs_ArePressedByTheirEdges) {
    state("online");
    list();
    EXPECT_THAT(values(1, {{"io/3", true}}), ElementsAre("io/3 true")) << "the first value is no edge";
    EXPECT_THAT(hear("asip/desk/io/out", R"({"digital":{"3":0}})"),
                ElementsAre("io/3 false", "io/3 release"));
    EXPECT_THAT(hear("asip/desk/io/out", R"({"digital":{"3":1}})"), ElementsAre("io/3 true", "io/3 press"));
    EXPECT_THAT(values(2, {{"io/3", false}}), IsEmpty()) << "an older document behind a report";
    EXPECT_THAT(hear("asip/desk/io/out", R"({"digital":{"3":0}})", true), IsEmpty());
    EXPECT_THAT(hear("asip/desk/io/out", "garbage"), IsEmpty());
}

TEST_F(SourcesTest, Away_AndBackIsNoPress) {
    state("online");
    list();
    values(1, {{"io/3", false}});
    EXPECT_THAT(state("lost"), ElementsAre("io/3 ?", "gone"));
    EXPECT_THAT(values(2, {{"io/3", true}}), IsEmpty());
    EXPECT_THAT(state("online"), ElementsAre("there", "io/3 true"));
}

TEST_F(SourcesTest, Connection_LostAndBackWithTheSameChangesNothing) {
    state("online");
    list();
    values(4, {{"io/2", true}, {"io/3", true}}, {{9, kPress}});
    EXPECT_THAT(words(sources.disconnected()), testing::Contains("gone"));
    sources.connected(now);
    EXPECT_THAT(values(4, {{"io/2", true}, {"io/3", true}}, {{9, kPress}}, true), IsEmpty());
    EXPECT_THAT(state("online", true), ElementsAre("there", "io/2 true", "io/3 true"));
}

TEST_F(SourcesTest, Bad_IsPassedOver) {
    state("online");
    list();
    for (const auto* payload : {"", "{", "[]", R"({"version":9})", "\xff"}) {
        EXPECT_THAT(hear("asip/desk/$values", payload), IsEmpty());
        EXPECT_THAT(hear("asip/servicebus/desk/$properties", payload), IsEmpty());
        EXPECT_THAT(hear("asip/other/$values", payload), IsEmpty());
    }
    EXPECT_THAT(values(1, {{"io/3", true}}), ElementsAre("io/3 true"));
}

}  // namespace
}  // namespace asip::links
