// SPDX-License-Identifier: Apache-2.0
#include "asip/property/documents.hpp"

#include "asip/model/json.hpp"
#include "tests/unit/property/boards.hpp"

namespace asip::property::test {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;
using testing::HasSubstr;

PropertyList whole_list() {
    auto board = board_with({"distance", "servo", "motors", "pixels", "lcd", "tone", "io"});
    board.labels.modes = {{2, 2}, {3, 5}, {13, 3}, {14, 4}};
    board.labels.meanings["io/2"].klass = "door";
    PropertyList list{{"desk", "005f3a9c0114c0de", 3}, properties(board)};
    for (auto& each : list.properties)
        each.setters.clear();  // the agent's alone
    return list;
}

json whole_document() {
    return *model::parse_json(to_text(whole_list()));
}

TEST(PropertyList, Written_IsReadTheSame) {
    const auto list = whole_list();
    const auto read = parse_list(to_text(list));
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(*read, list);
}

TEST(PropertyList, WithEachMember_IsReadTheSame) {
    const auto list = whole_list();
    const auto text = to_text(list, Members::kAll);
    const auto read = parse_list(text);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(*read, list);
    const auto document = json::parse(text);
    for (const auto& each : document["properties"])
        for (const auto* member : {"id", "name", "service", "kind", "type", "access"})
            EXPECT_TRUE(each.contains(member)) << each;
}

TEST(PropertyList, OnTheBus_HasNoMemberThatAReaderDerives) {
    const auto document = whole_document();
    for (const auto& each : document["properties"])
        for (const auto* member : {"service", "access", "type"})
            EXPECT_FALSE(each.contains(member)) << each;
    EXPECT_FALSE(document["properties"][0].contains("read")) << "distance/0 is read at /distance/0";
    auto length = whole_list();
    std::erase_if(length.properties, [](const auto& each) { return each.id != "distance/0"; });
    length.properties[0].whole = false;
    const auto read = parse_list(to_text(length));
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(*read, length);
}

TEST(PropertyList, Damaged_IsRefusedWithThePlace) {
    const auto fault = [](const json& document) {
        const auto read = parse_list(model::dump_json(document));
        return read ? std::string() : read.error();
    };
    auto document = whole_document();
    document["version"] = 2;
    EXPECT_THAT(fault(document), HasSubstr("version"));
    document = whole_document();
    document["properties"][1] = document["properties"][0];
    EXPECT_THAT(fault(document), HasSubstr("twice"));
    for (const auto* id : {"", "servo2/0/angle", "io/13", "../servo"}) {
        document = whole_document();
        document["properties"][0]["id"] = id;
        document["properties"][0]["service"] = "distance";
        EXPECT_THAT(fault(document), HasSubstr("/properties/0/id")) << "a board that lies: " << id;
    }
    document = whole_document();
    document["properties"][0]["kind"] = "dragon";
    EXPECT_THAT(fault(document), HasSubstr("/properties/0/kind"));
    document = whole_document();
    document["properties"][0]["min"] = "low";
    EXPECT_THAT(fault(document), HasSubstr("/properties/0/min"));
    for (int i = 0; i < 300; ++i)
        document["properties"].push_back(document["properties"][0]);
    EXPECT_NE(fault(document), "");
    EXPECT_FALSE(parse_list(std::string(kMaxListBytes + 1, ' ')));
    EXPECT_FALSE(parse_list("[]"));
}

TEST(ValueDocument, Written_IsReadTheSame) {
    KnownValues known;
    known.use(whole_list().properties, Time(10s));
    known.reported("distance", {{"distance", {42}}}, How::kReported, Time(10s));
    auto document = values_of(known, Time(12s));
    document.head = {"desk", "005f3a9c0114c0de", 4};
    document.clock = "1f3c09aa-123456";
    EXPECT_EQ(document.values.at("distance/0"), (ShownValue{42, How::kReported, Unknown::kNever, 2}));
    const auto read = parse_values(to_text(document));
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(*read, document);
}

TEST(ValueDocument, NothingSaidYet_IsLeftOutOnTheBusAndSaidToPeople) {
    ValueDocument document;
    document.head = {"desk", "s", 1};
    document.values["a/0"] = {{}, How::kNone, Unknown::kNever, 1};
    document.values["a/1"] = {{}, How::kNone, Unknown::kDoubt, 1};
    EXPECT_THAT(to_text(document),
                HasSubstr(R"("values":{"a/0":{"age":1},"a/1":{"age":1,"unknown":"doubt"}})"));
    EXPECT_THAT(to_text(document, Members::kAll), HasSubstr(R"("a/0":{"age":1,"unknown":"never"})"));
    const auto read = parse_values(to_text(document));
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(*read, document);
}

/// Readers take an object for a light.
TEST(ValueDocument, ObjectThatIsNoLight_IsNotKnown) {
    const auto read = [](const std::string& value) {
        const auto document = parse_values(
            R"({"version":1,"board":"desk","session":"s","seq":1,"values":{"a/0":{"how":"set","value":)" +
            value + "}}}");
        return document ? document->values.at("a/0") : ShownValue{"refused"};
    };
    for (const char* light : {R"({"on":false})", R"({"on":true,"brightness":255,"color":16777215})"})
        EXPECT_EQ(read(light).value, json::parse(light));
    for (const char* other :
         {"{}", R"({"on":1})", R"({"on":true,"brightness":"x"})", R"({"on":true,"brightness":256})",
          R"({"on":true,"color":{}})", R"({"on":true,"color":-1})", R"({"brightness":1})"})
        EXPECT_EQ(read(other), ShownValue()) << other;
}

TEST(ValueDocument, TooLong_LeavesOutAndSaysSo) {
    ValueDocument document;
    document.head = {"desk", "s", 1};
    for (int i = 0; i < 200; ++i)
        document.values["lcd/" + std::to_string(i) + "/text"] = {std::string(250, 'x'), How::kSet};
    const auto text = to_text(document);
    EXPECT_LE(text.size(), kMaxValuesBytes);
    const auto read = parse_values(text);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->left_out + read->values.size(), 200U);
    EXPECT_GT(read->left_out, 0U);
}

}  // namespace
}  // namespace asip::property::test
