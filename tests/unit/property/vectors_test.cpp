// SPDX-License-Identifier: Apache-2.0
// What programs in every language make of a board's properties: tests/vectors/properties.json, which the
// tests of the Python package and of the Node-RED nodes read, too. ASIP_WRITE_VECTORS=1 writes what is so
// now.
#include <cstdlib>
#include <fstream>

#include "asip/model/json.hpp"
#include "asip/property/documents.hpp"
#include "asip/property/value.hpp"
#include "asip/property/words.hpp"
#include "tests/unit/property/boards.hpp"

namespace asip::property::test {
namespace {

using nlohmann::json;

const char* const kFile = ASIP_SOURCE_DIR "/tests/vectors/properties.json";

/// A board on which people said what some pins are.
json list_of_all() {
    auto board = board_with({"distance", "servo", "motors", "pixels", "lcd", "io"});
    board.labels.modes = {{2, 2}, {3, 5}, {4, 1}, {7, 2}, {10, 5}, {12, 3}, {13, 3}, {14, 4}};
    board.labels.pins[13] = "status lamp";
    auto& meanings = board.labels.meanings;
    meanings["io/2"].klass = "door";
    meanings["io/5"].klass = "button";
    meanings["io/6"].klass = "moisture";
    meanings["io/7"].klass = "plug";  // which is no input
    meanings["io/10"].klass = meanings["io/11"].klass = "light";
    meanings["io/12"].inverted = true;
    meanings["io/14"].klass = "level";
    meanings["io/14"].unit = "%";
    meanings["io/14"].line = std::array<double, 4>{0, 1023, 0, 100};
    return *model::parse_json(to_text(PropertyList{{"desk", "005f3a9c0114c0de", 7}, properties(board)}));
}

json requests_of(const Property& property, const json& value) {
    auto made = json::array();
    for (const auto& [service, payload] : requests_for(property, value))
        made.push_back({service, json::parse(payload)});
    return made;
}

/// One line a member, and a line for each of its items, so that a change shows what it changes.
std::string written(const json& vectors) {
    std::string text = "{";
    for (const auto& [name, member] : vectors.items()) {
        text += (text.size() > 1 ? ",\n" : "\n") + json(name).dump() + ": ";
        const auto& items = name == "list" ? member.at("properties") : member;
        if (!items.is_array()) {
            text += member.dump();
            continue;
        }
        if (name == "list") {
            auto head = member;
            head.erase("properties");
            text += head.dump();
            text.back() = ',';
            text += "\"properties\": ";
        }
        text += "[";
        for (const auto& item : items)
            text += (text.back() == '[' ? "\n  " : ",\n  ") + item.dump();
        text += name == "list" ? "]}" : "]";
    }
    return text + "\n}\n";
}

class PropertyVectors : public testing::Test {
  protected:
    PropertyVectors() : vectors_(json::parse(std::ifstream(kFile))) {
        const auto list = parse_list(vectors_.at("list").dump());
        if (list) properties_ = list->properties;
    }

    /// Compares what each case of `name` says as `member`.
    void compare(const char* name, const char* member,
                 const std::function<json(const Property&, const json&)>& of) {
        EXPECT_GT(vectors_.at(name).size(), 8U);
        for (auto& each : vectors_.at(name)) {
            const auto found = std::find_if(properties_.begin(), properties_.end(), [&](const auto& one) {
                return one.id == each.at("id").get<std::string>();
            });
            const auto is = of(found == properties_.end() ? Property() : *found, each.at("value"));
            if (std::getenv("ASIP_WRITE_VECTORS") != nullptr) each[member] = is;
            EXPECT_EQ(is, each.value(member, json())) << each;
        }
        write();
    }

    void write() const {
        if (std::getenv("ASIP_WRITE_VECTORS") != nullptr) std::ofstream(kFile) << written(vectors_);
    }

    json changed(json document, const json& change) const {
        document[json::json_pointer(change.at(0).get<std::string>())] = change.at(1);
        return document;
    }

    json vectors_;
    std::vector<Property> properties_;
};

TEST_F(PropertyVectors, ListOfABoard_IsWhatTheFileSays) {
    const auto is = list_of_all();
    if (std::getenv("ASIP_WRITE_VECTORS") != nullptr) vectors_["list"] = is;
    write();
    EXPECT_EQ(is, vectors_.at("list"));
}

/// What the list does not say, since others of its members do.
TEST_F(PropertyVectors, MembersThatAreLeftOut_AreWhatTheFileSays) {
    auto is = json::array();
    for (const auto& each : properties_)
        is.push_back({each.id, each.service, to_json(each, Members::kAll).at("kind"), type_of(each),
                      access_of(each), each.name, each.choices});
    if (std::getenv("ASIP_WRITE_VECTORS") != nullptr) vectors_["left_out"] = is;
    write();
    EXPECT_EQ(is, vectors_["left_out"]);
}

TEST_F(PropertyVectors, DamagedDocuments_AreRefused) {
    EXPECT_TRUE(parse_list(vectors_.at("list").dump()));
    EXPECT_TRUE(parse_values(vectors_.at("values").dump()));
    for (const auto& each : vectors_.at("damaged_lists")) {
        const auto list = parse_list(changed(vectors_.at("list"), each).dump());
        EXPECT_FALSE(list && list->head.board == "desk") << each;
    }
    for (const auto& each : vectors_.at("damaged_values"))
        EXPECT_FALSE(parse_values(changed(vectors_.at("values"), each).dump())) << each;
}

TEST_F(PropertyVectors, CommandsThatSetAValue_AreWhatTheFileSays) {
    compare("set", "requests", requests_of);
}

TEST_F(PropertyVectors, WordsOfAValue_AreWhatTheFileSays) {
    compare("text", "text",
            [](const auto& property, const auto& value) { return json(value_text(property, value)); });
}

TEST_F(PropertyVectors, WordsOfWhatIsNotKnown_AreWhatTheFileSays) {
    const auto words =
        json::parse(std::ifstream(ASIP_SOURCE_DIR "/tests/vectors/reasons.json")).at("unknown");
    for (const auto why : {Unknown::kNever, Unknown::kRestart, Unknown::kDoubt})
        EXPECT_EQ(words.at(std::string(to_text(why))), unknown_text(why));
    EXPECT_EQ(words.size(), 3U);
}

}  // namespace
}  // namespace asip::property::test
