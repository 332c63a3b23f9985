// SPDX-License-Identifier: Apache-2.0
// Ids of properties are kept for ever: other systems hang histories and automations on them.
#include <fstream>
#include <set>
#include <sstream>

#include "tests/unit/property/boards.hpp"

namespace asip::property::test {
namespace {

using testing::ElementsAre;

std::string read_file(const std::string& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

/// "MODEL ID TYPE ACCESS PLAIN-ID", a line each, of all standard models on boards with two elements.
std::string table() {
    std::string text;
    for (const auto& model : model::ModelSet::standard().all()) {
        auto board = board_with({});
        add_service(board, model->name, 2);
        if (model->name == "io") board.labels.modes = {{2, 2}, {3, 5}, {13, 3}, {14, 4}};
        for (const auto& each : properties(board))
            text += model->name + " " + each.id + " " + std::string(type_of(each)) + " " +
                    std::string(access_of(each)) + " " + plain_id(each.id) + "\n";
    }
    return text;
}

TEST(PropertyIds, StandardModels_AreThoseOfTheCommittedTable) {
    const std::string path = ASIP_SOURCE_DIR "/tests/vectors/property_ids.txt";
    EXPECT_EQ(table(), read_file(path)) << "a new model adds lines to " << path << "; no line ever changes";
}

TEST(PropertyIds, CommandInFront_ChangesNoOtherId) {
    auto text = [](const std::string& commands) {
        return R"({"name":"arm","version":1,"id":"R","title":"Arm","element":"joint","events":{},"commands":{)" +
               commands + "}}";
    };
    const std::string turn =
        R"("turn":{"tag":"T","args":[{"name":"joint","type":"integer","min":0,"max":7},{"name":"v","type":"integer"}]})";
    const std::string early = R"("aim":{"tag":"A","args":[{"name":"x","type":"integer"}]})";
    const auto ids_with = [&](const std::string& commands) {
        auto model = model::parse_service_model(text(commands));
        EXPECT_TRUE(model) << model.error();
        const auto shared = std::make_shared<const model::ServiceModel>(std::move(*model));
        auto board = board_with({});
        add_service(board, "arm", 1);
        return ids(properties_of(board, [&](const auto&) { return shared; }));
    };
    EXPECT_THAT(ids_with(turn), ElementsAre("arm/0/v"));
    EXPECT_THAT(ids_with(early + "," + turn), testing::IsSupersetOf({"arm/0/v", "arm/x"}));
}

TEST(PropertyIds, ArgumentOfTwoCommands_NamesItsCommand) {
    auto model = model::parse_service_model(R"({"name":"arm","version":1,"id":"R","title":"Arm","commands":{)"
                                            R"("lift":{"tag":"L","args":[{"name":"v","type":"integer"}]},)"
                                            R"("turn":{"tag":"T","args":[{"name":"v","type":"integer"}]}}})");
    ASSERT_TRUE(model) << model.error();
    const auto shared = std::make_shared<const model::ServiceModel>(std::move(*model));
    auto board = board_with({});
    add_service(board, "arm");
    EXPECT_THAT(ids(properties_of(board, [&](const auto&) { return shared; })),
                testing::UnorderedElementsAre("arm/lift.v", "arm/turn.v"));
}

TEST(PlainId, OfDifferentIds_IsDifferent) {
    EXPECT_EQ(plain_id("servo/0/angle"), "servo-0-angle");
    std::set<std::string> seen;
    for (const auto* id : {"a/b", "a-b", "a.b", "a_b", "A/b", "ab", "a/-b", "a-/b", "a--b", "a/2d", "a-2d"})
        EXPECT_TRUE(seen.insert(plain_id(id)).second) << id << " " << plain_id(id);
}

}  // namespace
}  // namespace asip::property::test
