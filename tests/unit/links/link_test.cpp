// SPDX-License-Identifier: Apache-2.0
#include "asip/links/link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/property/boards.hpp"

namespace asip::links {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

const json kGood = {{"name", "l"}, {"from", "desk/io/2"}, {"to", "io/13"}};

Expected<Link> read(json changes) {
    auto document = kGood;
    document.update(changes);
    return read_link(document);
}

TEST(LinkTest, WhatIsWrittenIsRead) {
    for (const auto& changes :
         {json::object(), json{{"when", "toggles"}, {"after", 1.5}, {"disabled", true}, {"user", "ann"}},
          json{{"when", "above"},
               {"level", 30},
               {"back", 28.5},
               {"value", 5},
               {"else", 0},
               {"between", "22:00-06:00"}},
          json{{"line", {0, 1023, 0, 180}}, {"safe", true}},
          json{{"when", "press"}, {"for", 60}, {"value", true}},
          json{{"when", "hold"}, {"command", {{"play", {440, 200}}}}}}) {
        const auto link = read(changes);
        ASSERT_TRUE(link) << changes << link.error();
        EXPECT_EQ(read_link(to_json(*link)), *link) << changes;
        EXPECT_THAT(in_words(*link), HasSubstr("desk/io/2"));
    }
}

TEST(LinkTest, WhatCannotBeIsRefusedWithItsPlace) {
    const std::pair<json, const char*> kBad[] = {{{{"when", "toggle"}}, "did you mean \"toggles\""},
                                                 {{{"when", "above"}}, "/level: is missing"},
                                                 {{{"when", "above"}, {"level", 1}, {"back", 2}}, "/back"},
                                                 {{{"level", 1}}, "/level: goes with above and below"},
                                                 {{{"from", "desk"}}, "BOARD/PROPERTY"},
                                                 {{{"name", "a b"}}, "/name"},
                                                 {{{"to", ""}}, "/to"},
                                                 {{{"line", {0, 0, 1, 2}}}, "begins where it ends"},
                                                 {{{"line", {0, 1, 2}}}, "four numbers"},
                                                 {{{"line", {0, 1, 2, 3}}, {"when", "inverted"}}, "/line"},
                                                 {{{"between", "22-6"}}, "22:00-06:00"},
                                                 {{{"between", "24:00-06:00"}}, "22:00-06:00"},
                                                 {{{"after", -1}}, "/after"},
                                                 {{{"value", {1}}}, "/value"},
                                                 {{{"when", "toggles"}, {"for", 1}}, "/for"},
                                                 {{{"safe", true}, {"when", "press"}}, "/safe"},
                                                 {{{"command", {{"a", 1}}}, {"value", 1}}, "/command"},
                                                 {{{"from", "desk/#/a"}}, "BOARD/PROPERTY"},
                                                 {{{"from", "desk/+"}}, "BOARD/PROPERTY"},
                                                 {{{"from", "desk/io\n/2"}}, "BOARD/PROPERTY"},
                                                 {{{"to", "io/\x1b[2J"}}, "/to"},
                                                 {{{"command", json::object()}}, "one command"},
                                                 {{{"command", {{"raw", "1"}, {"id", "7"}}}}, "one command"},
                                                 {{{"colour", 1}}, "/colour"}};
    for (const auto& [changes, what] : kBad) {
        const auto link = read(changes);
        ASSERT_FALSE(link) << changes;
        EXPECT_THAT(link.error(), HasSubstr(what));
    }
    json list = json::array();
    for (int i = 0; i < 400; ++i)
        list.push_back(1e9);  // four bytes as someone writes it, and twelve as it is kept
    EXPECT_FALSE(read({{"command", {{"play", list}}}}));
    EXPECT_FALSE(read_link(json::array()));
    EXPECT_FALSE(read_link(json()));
}

TEST(LinkTest, Ends_AreCheckedWithTheNearest) {
    auto description = property::test::board_with({"io", "servo", "distance"});
    model::Meaning button;
    button.klass = "button";
    description.labels.meanings["io/2"] = button;
    description.labels.modes = {{2, 2}, {3, 2}, {13, 3}};
    description.pins.modes[2] = description.pins.modes[3] = '2';
    description.pins.modes[13] = '3';
    const auto properties = property::test::properties(description);
    auto link = *read(json::object());
    EXPECT_THAT(target_fault(link, properties), IsEmpty());
    EXPECT_THAT(source_fault(link, properties), IsEmpty());
    link.target = "io/113";
    EXPECT_THAT(target_fault(link, properties), HasSubstr("did you mean \"io/13\""));
    link.target = "io/2";
    EXPECT_THAT(target_fault(link, properties), HasSubstr("io/2"));
    link = *read({{"when", "hold"}, {"from", "desk/io/3"}});
    EXPECT_THAT(source_fault(link, properties), HasSubstr("class=button"));
    link = *read({{"when", "above"}, {"level", 1}});
    EXPECT_THAT(source_fault(link, properties), HasSubstr("is no number"));
    link.source = "io/22";
    EXPECT_THAT(source_fault(link, properties), HasSubstr("did you mean"));
}

TEST(LinkTest, Circle_IsNamed) {
    const std::vector<Ends> links{{"a/1", "b/1"}, {"b/1", "c/1"}, {"b/1", "d/1"}};
    EXPECT_EQ(circle(links, {"c/1", "a/1"}), "c/1, a/1, b/1, c/1");
    EXPECT_EQ(circle({}, {"a/1", "a/1"}), "a/1, a/1");
    EXPECT_EQ(circle(links, {"d/1", "c/1"}), "");
}

}  // namespace
}  // namespace asip::links
