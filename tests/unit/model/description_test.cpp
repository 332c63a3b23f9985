// SPDX-License-Identifier: Apache-2.0
#include "asip/model/description.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "asip/model/model_set.hpp"

namespace asip::model {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr auto kFan = R"({"name":"fan","version":1,"id":"F","match":["Fan"],"title":"A fan","examples":[]})";

Description uno() {
    Description d;
    d.board = "uno1";
    d.session = "5f3a9c01";
    d.seq = 3;
    d.firmware = {"0.4", "ATmega328P", "AsipHello", {{{'B', 1}, {'C', 1}, {'E', 1}, {'I', 1}}}};
    d.link = {"serial", "/dev/ttyACM0", 500000};
    d.agent = {"0.1.0", "pi", "asip-agent-1234"};
    d.pins = {"00111511151511333333",
              "@@IIIIIIISDIIIIIIIII",
              "66111111177111444444",
              {{14, 0}, {15, 1}, {16, 2}, {17, 3}, {18, 4}, {19, 5}}};
    d.services = {{"io", 'I', "io@1", nullptr, "ASIP core IO", {}, {}},
                  {"servo", 'S', "servo@1", nullptr, "Servos", 2, {}},
                  {"distance", 'D', "distance@1", nullptr, "Distance", 2, 100},
                  {"motors", 'M', "motors@1", nullptr, "Motors", 2, {}},
                  {"encoders", 'E', "encoders@1", nullptr, "Encoders", 2, 50}};
    return d;
}

std::string fault(const char* path, const json& value) {
    auto document = to_json(uno());
    document[json::json_pointer(path)] = value;
    const auto result = description_from_json(document);
    return result ? "" : result.error();
}

TEST(Description, WrittenAndRead_IsTheSame) {
    const auto read = parse_description(to_text(uno()));
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(*read, uno());
}

TEST(Description, FiveStandardServices_FitInOneKilobyte) {
    EXPECT_LE(to_text(uno()).size(), 1000u);
}

TEST(Description, OwnModel_IsCarriedInFullWithoutExamples) {
    auto description = uno();
    auto model = std::make_shared<const ServiceModel>(parse_service_model(kFan).value());
    description.services.push_back({"fan", 'F', "", model, "Big fan", {}, {}});
    const auto read = parse_description(to_text(description));
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(*read, description);
    EXPECT_EQ(read->service("fan")->own_model->ref(), "fan@1");
    EXPECT_EQ(to_text(description).find("examples"), std::string::npos);
}

TEST(Description, OnlyWhatIsRequired_IsEnough) {
    const auto read =
        parse_description(R"({"board":"b","session":"s","seq":0,"services":[],"later":{"x":1}})");
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->lease, kDefaultLeaseSeconds);
    EXPECT_TRUE(read->pins.empty());
    EXPECT_EQ(read->service("io"), nullptr);
}

TEST(Description, MissingMembers_AreNamed) {
    for (const auto* key : {"board", "session", "seq", "services"}) {
        auto document = to_json(uno());
        document.erase(key);
        EXPECT_EQ(description_from_json(document).error(), std::string("/") + key + ": is missing");
    }
}

TEST(Description, HostileMembers_AreRefusedWithPlaceAndReason) {
    EXPECT_EQ(fault("/board", "a/b"), "/board: 'a/b' is not a name: allowed are letters, digits and . _ -");
    EXPECT_EQ(fault("/board", "registry"), "/board: 'registry' is reserved");
    EXPECT_EQ(fault("/board", 7), "/board: is not a string");
    EXPECT_EQ(fault("/seq", -1), "/seq: -1 is below 0");
    EXPECT_EQ(fault("/seq", 1.5), "/seq: is not an integer");
    EXPECT_EQ(fault("/seq", 18446744073709551615u),
              "/seq: 18446744073709551615 is above 9223372036854775807");
    EXPECT_EQ(fault("/lease", 0), "/lease: 0 is below 1");
    EXPECT_EQ(fault("/lease", 86401), "/lease: 86401 is above 86400");
    EXPECT_EQ(fault("/firmware", "0.4"), "/firmware: is not an object");
    EXPECT_EQ(fault("/firmware/chip", std::string(257, 'x')), "/firmware/chip: is longer than 256 bytes");
    EXPECT_EQ(fault("/firmware/extensions/EE", 1), "/firmware/extensions: a tag is one character");
    EXPECT_EQ(fault("/firmware/extensions/\x1b", 1), "/firmware/extensions: a tag is one character");
    EXPECT_EQ(fault("/services/1/title", "\x1b[2J"), "/services/1/title: holds control characters");
    EXPECT_EQ(fault("/link/baud", "fast"), "/link/baud: is not an integer");
    EXPECT_EQ(fault("/pins/capabilities", "9"),
              "/pins/capabilities: holds a character that stands for nothing");
    EXPECT_EQ(fault("/pins/owners", std::string(257, 'I')), "/pins/owners: is longer than 256 bytes");
    EXPECT_EQ(fault("/pins/analog/999", 1), "/pins/analog: a key is not a pin");
    EXPECT_EQ(fault("/pins/analog/14", 256), "/pins/analog/14: 256 is above 255");
    EXPECT_EQ(fault("/services", json::object()), "/services: is not an array");
    EXPECT_EQ(fault("/services/1", 7), "/services/1: is not an object");
    EXPECT_EQ(fault("/services/1/name", "a/b"), "/services/1/name: is not a valid name");
    EXPECT_EQ(fault("/services/1/name", "io"), "/services/1/name: is there twice");
    EXPECT_EQ(fault("/services/1/id", "s"), "/services/1/id: is not a letter A to Z");
    EXPECT_EQ(fault("/services/1/model", "servo"), "/services/1/model: is not NAME@VERSION");
    EXPECT_EQ(fault("/services/1/model", 7), "/services/1/model: is neither a name nor a model");
    EXPECT_THAT(fault("/services/1/model", json::object()), HasSubstr("/services/1/model: /: has no member"));
    EXPECT_EQ(fault("/services/1/count", 65536), "/services/1/count: 65536 is above 65535");
}

TEST(Description, TooManyServicesOrBytes_AreRefused) {
    auto document = to_json(uno());
    for (int i = 0; i < 60; ++i)
        document["services"].push_back({{"name", "s" + std::to_string(i)}});
    EXPECT_EQ(description_from_json(document).error(), "/services: has more than 64 items");
    EXPECT_FALSE(parse_description(std::string(70000, ' ')));
    EXPECT_FALSE(parse_description(std::string(60000, '[')));
    for (const std::string_view text : {"", "[]", "null", "7", "\"x\"", "{"})
        EXPECT_FALSE(parse_description(text)) << text;
}

TEST(BoardState, EachWord_IsThereOrGoneAndTakesCommandsOrNot) {
    for (const auto* word : {"online", "sleeping"})
        EXPECT_TRUE(!is_gone(word) && takes_commands(word)) << word;
    EXPECT_TRUE(!is_gone("updating") && !takes_commands("updating"));
    for (const auto* word : {"lost", "offline"})
        EXPECT_TRUE(is_gone(word) && !takes_commands(word)) << word;
    // What a view does not know, and a word of a later version, is neither.
    for (const auto* word : {"unknown", "of-a-later-version", ""})
        EXPECT_TRUE(!is_gone(word) && !takes_commands(word)) << word;
}

}  // namespace
}  // namespace asip::model
