// SPDX-License-Identifier: Apache-2.0
#include "asip/model/labels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "asip/model/description.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::model {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

std::string fault_of(std::string_view text, std::string_view service = {}) {
    LabelChange change;
    const auto added = add_assignment(change, text, service);
    return added ? std::string() : added.error();
}

Labels labels_from(const std::string& text, std::string& fault) {
    const auto document = nlohmann::json::parse(text);
    text::JsonReader reader(document, "", fault);
    return read_labels(reader);
}

std::string read_fault(const std::string& text) {
    std::string fault;
    labels_from(text, fault);
    return fault;
}

TEST(Labels, Assignments_AreWhatPeopleWrite) {
    LabelChange change;
    for (const char* text :
         {"room=lab", "floor-", "pin.13=status lamp", "pin.9-", "servo/name=left arm", "note="})
        ASSERT_TRUE(add_assignment(change, text)) << text;
    ASSERT_TRUE(add_assignment(change, "name=ears", "distance"));
    EXPECT_EQ(change, (LabelChange{{{"room", "lab"}, {"floor", std::nullopt}, {"note", ""}},
                                   {{"servo", "left arm"}, {"distance", "ears"}},
                                   {{13, "status lamp"}, {9, std::nullopt}}}));
}

TEST(Labels, ValueMayHoldWhatPeopleWrite_ButNothingThatMovesACursor) {
    EXPECT_THAT(fault_of("owner=Ann = \"A\", Zoë 🤖"), IsEmpty());
    EXPECT_THAT(fault_of("a=" + std::string(63, 'x')), IsEmpty());
    EXPECT_THAT(fault_of("a=" + std::string(64, 'x')), HasSubstr("at most 63"));
    EXPECT_THAT(fault_of("a=x\ny"), HasSubstr("control characters"));
    EXPECT_THAT(fault_of("a=\xc2\x9b"), HasSubstr("control characters"));
    EXPECT_THAT(fault_of("a=\xff"), HasSubstr("not UTF-8"));
    EXPECT_THAT(fault_of("a=\u202eevil"), HasSubstr("no one sees"));
    EXPECT_THAT(fault_of("a=\U0001f468\u200d\U0001f467"), IsEmpty());
    EXPECT_THAT(fault_of("a= x"), HasSubstr("blank"));
}

TEST(Labels, WrongKeys_AreExplained) {
    EXPECT_THAT(fault_of("room"), HasSubstr("write KEY=VALUE"));
    EXPECT_THAT(fault_of("-"), HasSubstr("write KEY=VALUE"));
    EXPECT_THAT(fault_of("=x"), HasSubstr("empty"));
    EXPECT_THAT(fault_of("my room=x"), HasSubstr("is not a key"));
    EXPECT_THAT(fault_of(".a=x"), HasSubstr("is not a key"));
    EXPECT_THAT(fault_of("a.=x"), HasSubstr("is not a key"));
    EXPECT_THAT(fault_of("räum=x"), HasSubstr("is not a key"));
    EXPECT_THAT(fault_of(std::string(64, 'k') + "=x"), HasSubstr("at most 63"));
    EXPECT_THAT(fault_of("pin.256=x"), HasSubstr("is not a pin"));
    EXPECT_THAT(fault_of("pin.013=x"), HasSubstr("is not a pin"));
    EXPECT_THAT(fault_of("pin.=x"), HasSubstr("is not a pin"));
    EXPECT_THAT(fault_of("pin.13="), HasSubstr("is empty"));
    EXPECT_THAT(fault_of("room=x", "servo"), HasSubstr("only its name"));
    EXPECT_THAT(fault_of("ser vo/name=x"), HasSubstr("not the name of a service"));
}

TEST(Labels, Change_SetsAndRemovesAndLeavesTheRest) {
    const Labels before{{{"room", "lab"}, {"floor", "2"}}, {{"servo", "arm"}}, {{13, "lamp"}}};
    const auto after = changed(before, {{{"floor", std::nullopt}, {"shelf", "3"}}, {}, {{13, "light"}}});
    ASSERT_TRUE(after);
    EXPECT_EQ(*after, (Labels{{{"room", "lab"}, {"shelf", "3"}}, {{"servo", "arm"}}, {{13, "light"}}}));
}

TEST(Labels, Bounds_Hold) {
    Labels full;
    for (std::size_t i = 0; i < kMaxLabels; ++i)
        full.labels["k" + std::to_string(i)] = "v";
    for (int i = 0; i < static_cast<int>(kMaxFriendlyNames); ++i)
        full.pins[i] = "n";
    EXPECT_TRUE(changed(full, {{{"k0", "w"}}, {}, {}}));
    EXPECT_THAT(changed(full, {{{"one", "more"}}, {}, {}}).error(), HasSubstr("at most 32 labels"));
    EXPECT_THAT(changed(full, {{}, {{"servo", "arm"}}, {}}).error(), HasSubstr("at most 64 names"));
    EXPECT_TRUE(changed(full, {{{"k0", std::nullopt}, {"one", "more"}}, {}, {}}));
}

TEST(Labels, Description_CarriesThemAndReadsThemBack) {
    Description description;
    description.board = "desk";
    description.session = "1";
    description.labels = {{{"room", "lab"}}, {{"servo", "left \"arm\""}}, {{13, "lamp"}}};
    const auto text = to_text(description);
    EXPECT_THAT(text, HasSubstr(R"("labels":{"room":"lab"})"));
    EXPECT_THAT(text, HasSubstr(R"("names":{"pins":{"13":"lamp"},"services":{"servo":)"));
    const auto back = parse_description(text);
    ASSERT_TRUE(back) << back.error();
    EXPECT_EQ(back->labels, description.labels);
    description.labels = {};
    EXPECT_THAT(to_text(description), testing::Not(HasSubstr("labels")));
}

TEST(Labels, LargestOnes_FitIntoADescriptionManyTimes) {
    Description description;
    description.board = "desk";
    description.session = "1";
    const std::string wide(kMaxLabelBytes, '"');  // two bytes each in JSON
    for (std::size_t i = 0; i < kMaxLabels; ++i)
        description.labels.labels[std::string(61, 'k') + std::to_string(10 + i)] = wide;
    for (int i = 0; i < static_cast<int>(kMaxFriendlyNames); ++i)
        description.labels.services[std::string(62, 's') + std::to_string(10 + i)] = wide;
    EXPECT_LT(to_text(description).size(), kMaxDescriptionBytes / 3);
    EXPECT_TRUE(parse_description(to_text(description)));
}

TEST(Labels, WhatADescriptionMustNotHold_IsNamedWithItsPlace) {
    EXPECT_THAT(read_fault(R"({"labels":[]})"), HasSubstr("/labels: is not an object"));
    EXPECT_THAT(read_fault(R"({"labels":{"room":1}})"), HasSubstr("/labels/room: is not a string"));
    EXPECT_THAT(read_fault(R"({"labels":{"room":null}})"), HasSubstr("/labels/room: is not a string"));
    EXPECT_THAT(read_fault(R"({"labels":{"r m":"x"}})"), HasSubstr("is not a key"));
    EXPECT_THAT(read_fault(R"({"labels":{"pin.1":"x"}})"), HasSubstr("names of pins"));
    EXPECT_THAT(read_fault(R"({"names":{"pins":{"-1":"x"}}})"), HasSubstr("is not a pin"));
    EXPECT_THAT(read_fault(R"({"names":{"pins":{"1":""}}})"), HasSubstr("is empty"));
    EXPECT_THAT(read_fault(R"({"names":{"services":{"a/b":"x"}}})"), HasSubstr("not the name of a service"));
    EXPECT_THAT(read_fault(R"({"names":{"later":{"a":"x"}}})"), IsEmpty()) << "later versions may add some";
    auto many = nlohmann::json::object();
    for (int i = 0; i < 33; ++i)
        many["labels"]["k" + std::to_string(i)] = "v";
    EXPECT_THAT(read_fault(many.dump()), HasSubstr("more than 32 members"));
    auto names = nlohmann::json::object();
    for (int i = 0; i < 40; ++i) {
        names["names"]["pins"][std::to_string(i)] = "p";
        names["names"]["services"]["s" + std::to_string(i)] = "s";
    }
    EXPECT_THAT(read_fault(names.dump()), HasSubstr("at most 64 names"));
}

}  // namespace
}  // namespace asip::model
