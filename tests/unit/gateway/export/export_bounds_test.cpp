// SPDX-License-Identifier: Apache-2.0
// What one board may take of other systems, and names that are chosen like the ids of other boards there.
#include <gmock/gmock.h>

#include "export_world.hpp"
#include "gateway/export/homie.hpp"
#include "gateway/export/sparkplug_node.hpp"

namespace asip::gateway::exports {
namespace {

using testing::ElementsAre;

/// As a board of 11 kB can say of itself, with words as long as they may be.
ExportedBoard long_board() {
    ExportedBoard board;
    for (int i = 0; i < 256; ++i) {
        auto& property = board.properties.emplace_back();
        property.id = "own/" + std::to_string(i);
        property.service = "own";
        property.name = std::string(64, 'n') + std::to_string(i);
        property.kind = Kind::kSelect;
        property.write = property::Call{"own", "set", {std::nullopt}};
        for (int word = 0; word < 32; ++word)
            property.choices.emplace_back(std::string(60, 'w') + std::to_string(word), word);
    }
    return board;
}

TEST(ExportBounds, BoardWithMoreThanADocumentHasRoomFor_IsShownInPart_InEachSystem) {
    SparkplugNode::Options node;
    node.dialect.group = "plant";
    node.gateway = "gw1";
    node.host = "machine";
    const std::vector<std::pair<std::shared_ptr<const Dialect>, std::string>> systems{
        {ExportWorld::home_assistant(), "homeassistant/device/asip-uno1/config"},
        {std::make_shared<Homie>(Homie::Options{}), "homie/5/uno1/$description"},
        {nullptr, "spBv1.0/plant/DBIRTH/asip/uno1"}};
    for (const auto& [dialect, topic] : systems) {
        ExportWorld world(1, dialect);
        world.put("uno1", long_board());
        if (dialect)
            world.start();
        else
            world.start([node](Random random, Export::Port port) {
                return std::make_unique<SparkplugNode>(node, std::move(random), std::move(port));
            });
        world.pass(3s);
        std::size_t longest = 0;
        for (const auto& each : world.sent)
            if (each.topic == topic) longest = std::max(longest, each.payload.size());
        EXPECT_GT(longest, kMaxDocument / 2) << topic;
        EXPECT_LE(longest, kMaxDocument) << topic;
        const auto times = world.times_sent(topic);
        world.put("uno1", long_board());
        world.pass(5s);
        EXPECT_EQ(world.times_sent(topic), times) << "the same board again: " << topic;
    }
}

TEST(ExportIds, NameThatIsChosenLikeAnId_IsAnother) {
    const std::vector<std::string> names{"uno.1", "uno_1", "uno__2e1", "uno__5f__5f2e1", "uno-1", "uno..1",
                                         "Uno-1", "a_b",   "a--5fb",   "a--2d--2d5fb",   "a.b",   "A-b",
                                         "a-b",   "asip",  "asip--",   "asip--2d--2d"};
    const HomeAssistant ha({});
    const Homie homie({});
    std::set<std::string> documents, ids;
    for (const auto& name : names) {
        documents.insert(ha.document_topic(name));
        ids.insert(homie.id_of(name));
        EXPECT_EQ(homie.name_of(homie.id_of(name)), name);
    }
    EXPECT_EQ(documents.size(), names.size());
    EXPECT_EQ(ids.size(), names.size());
    EXPECT_FALSE(ids.contains("asip")) << "that is the gateway's";
    for (const auto& id : ids)
        EXPECT_EQ(id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"), std::string::npos) << id;
}

TEST(ExportIds, DocumentsOfAnotherBusWhoseRootBeginsAlike_AreNotOurs) {
    HomeAssistant::Options other;
    other.root = "asip-lab";
    const HomeAssistant ours({}), theirs(other);
    auto board = exported(1);
    board.board = "uno1";
    Dialect::Retained found;
    for (const auto* each : {&ours, &theirs})
        found[each->document_topic("uno1")] = each->document(board);
    EXPECT_TRUE(ours.is_ours(found, ours.document_topic("uno1"), "homeassistant"));
    EXPECT_FALSE(ours.is_ours(found, theirs.document_topic("uno1"), "homeassistant"));
}

}  // namespace
}  // namespace asip::gateway::exports
