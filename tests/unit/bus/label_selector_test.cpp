// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/label_selector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "asip/bus/registry/query.hpp"
#include "asip/bus/request/agent_requests.hpp"

namespace asip::bus {
namespace {

using testing::HasSubstr;

const std::map<std::string, std::string> kDesk{{"room", "lab"}, {"floor", "2"}, {"owner", "Smith, \"Ann\""}};

bool chooses(std::string_view text) {
    const auto selector = LabelSelector::parse(text);
    EXPECT_TRUE(selector) << selector.error();
    return selector && selector->matches(kDesk);
}

TEST(LabelSelector, Terms_AreThoseOfKubectl) {
    for (const char* text :
         {"room=lab", "room==lab", "room!=hall", "room", "!camera", "room=lab,floor=2,!old",
          " room = lab , floor != 3 ", "camera!=big", R"(owner="Smith, \"Ann\"")"})
        EXPECT_TRUE(chooses(text)) << text;
    for (const char* text :
         {"room=hall", "room!=lab", "camera", "!room", "room=lab,floor=3", "room=", "room=Lab"})
        EXPECT_FALSE(chooses(text)) << text;
}

TEST(LabelSelector, Text_IsReadBackAsTheSame) {
    for (const char* text : {"room=lab,floor!=2,camera,!old", R"(owner="a, \"b\" \\",x=)"}) {
        const auto selector = LabelSelector::parse(text);
        ASSERT_TRUE(selector);
        EXPECT_EQ(LabelSelector::parse(selector->text()), *selector) << text;
    }
}

TEST(LabelSelector, WhatCannotBeMeant_IsExplained) {
    const auto why = [](std::string_view text) { return LabelSelector::parse(text).error(); };
    EXPECT_THAT(why(""), HasSubstr("would choose every board"));
    EXPECT_THAT(why("  "), HasSubstr("would choose every board"));
    EXPECT_THAT(why("room=lab,"), HasSubstr("a term is empty"));
    EXPECT_THAT(why("=lab"), HasSubstr("write KEY=VALUE"));
    EXPECT_THAT(why("room in (a b)"), HasSubstr("write KEY=VALUE, KEY!=VALUE, KEY or !KEY"));
    EXPECT_THAT(why("!room=lab"), HasSubstr("is not a key"));
    EXPECT_THAT(why("pin.13=lamp"), HasSubstr("names of pins"));
    EXPECT_THAT(why("room=\"lab"), HasSubstr("never closed"));
    EXPECT_THAT(why("room=\"lab\"x"), HasSubstr("a comma is missing"));
    EXPECT_THAT(why("room=" + std::string(64, 'x')), HasSubstr("at most 63"));
    EXPECT_THAT(why(std::string(2000, 'x')), HasSubstr("longer than"));
    std::string many = "a";
    for (int i = 0; i < 40; ++i)
        many += ",a";
    EXPECT_THAT(why(many), HasSubstr("more than 32 terms"));
}

TEST(LabelSelector, Query_CarriesItAndRefusesAWrongOne) {
    Query query;
    query.labels = *LabelSelector::parse("room=lab,!old");
    const auto text = encode(RegistryRequest{query, {}, {}});
    EXPECT_THAT(text, HasSubstr(R"("labels":"room=lab,!old")"));
    const auto back = read_registry_request(nlohmann::json::parse(text));
    ASSERT_TRUE(back) << back.error();
    EXPECT_EQ(std::get<Query>(*back), query);
    const auto wrong = read_registry_request({{"find", "boards"}, {"labels", "a b=c"}});
    ASSERT_FALSE(wrong);
    EXPECT_THAT(wrong.error(), HasSubstr("/labels: 'a b' is not a key"));
}

TEST(LabelRequest, ChangesAreReadBackAsTheyWereWritten) {
    model::LabelChange change;
    for (const char* word : {"room=lab", "old-", "pin.13=lamp", "servo/name=arm", "tone/name-"})
        ASSERT_TRUE(model::add_assignment(change, word));
    auto object = nlohmann::json::parse(encode(change, "anna"));
    EXPECT_EQ(object["by"], "anna");
    object.erase("by");  // the envelope's
    ASSERT_TRUE(is_label_request(object));
    const auto back = read_label_request(object);
    ASSERT_TRUE(back) << back.error();
    EXPECT_EQ(*back, change);
    EXPECT_TRUE(is_label_request(nlohmann::json::parse(encode(model::LabelChange{}, {}))))
        << "asks for what there is";
}

TEST(LabelRequest, Misspelt_IsRefused) {
    const auto why = [](const char* text) { return read_label_request(nlohmann::json::parse(text)).error(); };
    EXPECT_THAT(why(R"({"labels":{},"nams":{}})"), HasSubstr("/nams: is unknown"));
    EXPECT_THAT(why(R"({"names":{"pin":{"13":"x"}}})"),
                HasSubstr(R"(/names/pin: is unknown (did you mean "pins"?))"));
    EXPECT_THAT(why(R"({"labels":{"room":7}})"), HasSubstr("/labels/room: is not a string"));
}

}  // namespace
}  // namespace asip::bus
