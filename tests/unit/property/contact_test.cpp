// SPDX-License-Identifier: Apache-2.0
// Buttons and doors: contacts that bounce, and what is done with a button.
#include "asip/property/contact.hpp"

#include "asip/property/documents.hpp"
#include "asip/property/known_values.hpp"
#include "tests/unit/property/boards.hpp"

namespace asip::property::test {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

class ContactTest : public testing::Test {
  protected:
    ContactTest() { use("button"); }
    void use(const std::string& klass) {
        auto board = board_with({"io"});
        board.labels.modes[2] = 2;  // with a pull-up
        board.labels.meanings["io/2"].klass = klass;
        known_.use(properties(board), now_);
        known_.reported("io", {{"digital", {{"2", 1}}}}, How::kAnswered, now_);
    }
    /// The board says a level of the pin; counts the values that were told.
    void say(int level) {
        values_ += known_.reported("io", {{"digital", {{"2", level}}}}, How::kReported, now_);
    }
    void pass(Duration time) {
        const auto until = now_ + time;
        for (auto due = known_.next_deadline(); due && *due <= until; due = known_.next_deadline()) {
            now_ = std::max(now_, *due);
            values_ += known_.tick(now_);
            keep();
        }
        now_ = until;
    }
    void press_bouncing() {
        for (int i = 0; i < 6; ++i) {
            say(i % 2);
            pass(2ms);
        }
        say(0);
        keep();
    }
    void release_bouncing() {
        for (int i = 0; i < 5; ++i) {
            say(1 - i % 2);
            pass(3ms);
        }
        keep();
    }
    json value() const { return known_.known(0).value; }
    /// All events so far, each once, as a reader takes them.
    const std::vector<std::string>& acts() {
        keep();
        return acts_;
    }
    void keep() {
        for (const auto& [number, act] : known_.events(0, now_))
            if (number > last_) {
                EXPECT_EQ(number, last_ + 1) << "none is left out";
                last_ = number;
                acts_.emplace_back(to_text(act));
            }
    }

    Time now_{1000s};
    KnownValues known_;
    int values_ = 0;
    std::uint64_t last_ = 0;
    std::vector<std::string> acts_;
};

TEST_F(ContactTest, LevelThatIsKnownFirst_IsNoEvent) {
    EXPECT_EQ(value(), false);
    EXPECT_THAT(acts(), IsEmpty());
}

TEST_F(ContactTest, PressThatBounces_IsOneValueAtOnce) {
    say(0);
    EXPECT_EQ(value(), true) << "at once";
    press_bouncing();
    pass(100ms);
    EXPECT_EQ(value(), true);
    EXPECT_EQ(values_, 1) << "a bounce makes no second value";
    EXPECT_THAT(acts(), ElementsAre("press"));
    release_bouncing();
    pass(100ms);
    EXPECT_EQ(value(), false);
    EXPECT_EQ(values_, 2);
    EXPECT_THAT(acts(), ElementsAre("press", "release"));
}

TEST_F(ContactTest, PressShorterThanTheBouncing_IsTold) {
    say(0);
    pass(5ms);
    say(1);
    EXPECT_EQ(value(), true);
    pass(25ms);
    EXPECT_EQ(value(), false) << "the level that it has once it is quiet";
    EXPECT_THAT(acts(), ElementsAre("press", "release"));
}

TEST_F(ContactTest, PressedLong_IsHeldOnce) {
    say(0);
    pass(799ms);
    EXPECT_THAT(acts(), ElementsAre("press"));
    pass(1ms);
    EXPECT_THAT(acts(), ElementsAre("press", "hold"));
    pass(10s);
    say(1);
    pass(1s);
    EXPECT_THAT(acts(), ElementsAre("press", "hold", "release"));
}

TEST_F(ContactTest, PressedTwice_IsDoubleInAddition) {
    for (int i = 0; i < 2; ++i) {
        say(0);
        pass(100ms);
        say(1);
        pass(100ms);
    }
    EXPECT_THAT(acts(), ElementsAre("press", "release", "press", "double", "release"));
    say(0);
    pass(100ms);
    EXPECT_EQ(acts().back(), "press") << "a third one begins anew";
}

TEST_F(ContactTest, PressedAgainLater_IsNotDouble) {
    say(0);
    pass(100ms);
    say(1);
    pass(301ms);
    say(0);
    EXPECT_THAT(acts(), ElementsAre("press", "release", "press"));
}

TEST_F(ContactTest, BoardRestarts_WhileItIsPressed_NothingIsHeldAndNumbersGoOn) {
    say(0);
    EXPECT_THAT(acts(), ElementsAre("press"));
    known_.forget(now_);
    pass(2s);
    say(1);
    pass(1s);
    say(0);
    EXPECT_THAT(acts(), ElementsAre("press", "press"));
}

TEST_F(ContactTest, Door_IsQuietAndHasNoEvents) {
    use("door");
    values_ = 0;
    press_bouncing();
    pass(1s);
    EXPECT_EQ(values_, 1);
    EXPECT_THAT(acts(), IsEmpty());
}

TEST_F(ContactTest, OtherClass_TellsEachLevel) {
    use("motion");
    values_ = 0;
    press_bouncing();
    EXPECT_EQ(values_, 7);
}

TEST_F(ContactTest, ElectricalLevels_AreThoseOfTheBoard) {
    say(0);
    say(1);
    EXPECT_EQ(value(), true);
    EXPECT_EQ(known_.pins("io")["digital"]["2"], 1);
}

TEST_F(ContactTest, EventsInADocument_AreThoseOfTheLastSecondAndReadTheSame) {
    say(0);
    pass(900ms);
    auto document = values_of(known_, now_);
    document.head = {"desk", "005f3a9c0114c0de", 8};
    const auto read = parse_values(to_text(document));
    ASSERT_TRUE(read) << read.error();
    EXPECT_THAT(read->values.at("io/2").events,
                ElementsAre(ButtonEvent{1, ButtonAct::kPress}, ButtonEvent{2, ButtonAct::kHold}));
    pass(200ms);
    EXPECT_THAT(values_of(known_, now_).values.at("io/2").events,
                ElementsAre(ButtonEvent{2, ButtonAct::kHold}));
}

TEST_F(ContactTest, EventsOfALaterVersion_ArePassedOver) {
    const auto read_events = [](const std::string& events) {
        return parse_values(R"({"version":1,"board":"desk","session":"a","seq":1,"values":{"io/2":)"
                            R"({"value":true,"how":"reported","age":0,"events":)" +
                            events + "}}}");
    };
    const auto read = read_events(R"([[1,"press"],[2,"triple"],[3,"release"]])");
    ASSERT_TRUE(read) << read.error();
    EXPECT_THAT(read->values.at("io/2").events,
                ElementsAre(ButtonEvent{1, ButtonAct::kPress}, ButtonEvent{3, ButtonAct::kRelease}));
    for (const auto* bad : {R"([[1]])", R"([["1","press"]])", R"([[-1,"press"]])", R"({"1":"press"})", "7"})
        EXPECT_FALSE(read_events(bad)) << bad;
}

}  // namespace
}  // namespace asip::property::test
