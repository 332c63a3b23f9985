// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/homie.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "export_world.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

ExportedBoard homie_board() {
    auto board = exported(1);
    board.board = "uno1";
    board.properties[0].unit = "cm";
    board.properties[0].quantity = "distance";
    Property line;
    line.id = "display/0";
    line.service = "display";
    line.name = "Line 0";
    line.kind = Kind::kText;
    line.max_length = 20;
    line.write = property::Call{"display", "line", {0, std::nullopt}};
    for (auto& each : {strip_of_pixels(), stop_button(), line})
        board.properties.push_back(each);
    return board;
}

json described(const Homie& homie, const std::string& on_bus = {}) {
    return json::parse(homie.next_document(homie_board(), on_bus).text);
}

TEST(HomieDescription, HasANodeForEachService_AndAPropertyForEachEntity) {
    const auto document = described(Homie({}));
    EXPECT_EQ(document["homie"], "5.0");
    EXPECT_EQ(document["root"], "asip");
    EXPECT_EQ(document["version"], 1);
    EXPECT_EQ(document["nodes"]["distance"]["properties"]["distance-0"],
              json::parse(R"({"name":"Distance 0","datatype":"float","settable":false,"unit":"cm"})"));
    EXPECT_EQ(document["nodes"]["servo"]["properties"]["servo-0-angle"],
              json::parse(R"({"name":"Servo angle","datatype":"integer","settable":true,"format":"0:180"})"));
    EXPECT_EQ(document["nodes"]["pixels"]["properties"]["pixels-light"]["format"], "rgb");
    EXPECT_EQ(
        document["nodes"]["motors"]["properties"]["motors-stop"],
        json::parse(
            R"({"name":"Motors stop","datatype":"enum","settable":true,"format":"press","retained":false})"));
}

TEST(HomieDescription, VersionGrows_WhenItSaysSomethingElse) {
    const Homie homie({});
    const auto first = homie.next_document(homie_board(), {}).text;
    EXPECT_EQ(homie.next_document(homie_board(), first).text, first);
    auto board = homie_board();
    board.name = "Other";
    const auto second = json::parse(homie.next_document(board, first).text);
    EXPECT_EQ(second["version"], 2);
    EXPECT_EQ(described(homie, "no document")["version"], 1);
    for (const char* other : {R"({"version":9223372036854775807})", R"({"version":-5})"})
        EXPECT_EQ(described(homie, other)["version"], 1) << other;
    EXPECT_EQ(described(homie, R"({"version":"x"})")["version"], 1);
}

TEST(HomieDescription, ReadOnly_HasNothingToSet) {
    Homie::Options options;
    options.read_only = true;
    const auto text = Homie(options).next_document(homie_board(), {}).text;
    EXPECT_EQ(text.find("\"settable\":true"), std::string::npos);
    EXPECT_EQ(text.find("press"), std::string::npos);
}

TEST(HomieId, IsOneForEachBoard_AndNeverThatOfTheGateway) {
    const Homie homie({});
    EXPECT_EQ(homie.id_of("uno-1"), "uno-1");
    const std::set<std::string> ids{homie.id_of("Uno-1"), homie.id_of("uno_1"), homie.id_of("uno.1"),
                                    homie.id_of("uno-1"), homie.id_of("asip")};
    EXPECT_EQ(ids.size(), 5u);
    for (const auto& id : ids)
        EXPECT_EQ(id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"), std::string::npos) << id;
    EXPECT_NE(homie.id_of("asip"), "asip");
}

TEST(HomieValue, IsTextOfItsType) {
    const Homie homie({});
    const auto board = homie_board();
    const auto text = [&](const char* id, const char* value) {
        return homie.state_text(*board.property(id), json::parse(value));
    };
    EXPECT_EQ(text("distance-0", "42.5"), "42.5");
    EXPECT_EQ(text("distance-0", "null"), "");
    EXPECT_EQ(text("display-0", "\"\""), std::string(1, '\0'));
    EXPECT_EQ(text("display-0", "\"hi\""), "hi");
    EXPECT_EQ(text("pixels-light", R"({"on":false})"), "rgb,0,0,0");
    EXPECT_EQ(text("pixels-light", R"({"on":true,"brightness":255,"color":16744448})"), "rgb,255,128,0");
    EXPECT_EQ(text("pixels-light", R"({"on":true,"brightness":51,"color":16711680})"), "rgb,51,0,0");
    Property lamp;
    lamp.kind = Kind::kSwitch;
    EXPECT_EQ(homie.state_text(lamp, true), "true");
}

TEST(HomieValue, ThatIsSet_IsAValueOfTheEntity) {
    const Homie homie({});
    const auto board = homie_board();
    const auto value = [&](const char* id, const std::string& payload) {
        const auto result = homie.value_of(*board.property(id), payload);
        return result ? result->dump() : "none";
    };
    EXPECT_EQ(value("servo-0-angle", "90"), "90");
    EXPECT_EQ(value("pixels-light", "rgb,51,0,0"), R"({"brightness":51,"color":16711680,"on":true})");
    EXPECT_EQ(value("pixels-light", "rgb,0,0,0"), R"({"on":false})");
    EXPECT_EQ(value("motors-stop", "press"), "null");
    EXPECT_EQ(value("display-0", std::string(1, '\0')), "\"\"");
    for (const char* wrong : {"181", "", "x", "nan", "1e999", "90x"})
        EXPECT_EQ(value("servo-0-angle", wrong), "none") << wrong;
    for (const char* wrong :
         {"rgb,1,2", "rgb,1,2,3,4", "rgb,256,0,0", "rgb,-1,0,0", "hsv,1,2,3", "rgb,,,", "true"})
        EXPECT_EQ(value("pixels-light", wrong), "none") << wrong;
    EXPECT_EQ(value("motors-stop", ""), "none");
    EXPECT_EQ(value("distance-0", "1"), "none");
    EXPECT_EQ(value("display-0", std::string(5000, 'x')), "none");
}

class ExportedToHomie : public testing::Test {
  protected:
    ExportWorld::Gateway& start() {
        world_.put("uno1", homie_board());
        auto& gateway = world_.start();
        world_.pass(5s);
        return gateway;
    }
    /// Topics of a device in the order in which they were sent from `begin` on.
    std::vector<std::string> sent_of(const std::string& device, std::size_t begin) const {
        std::vector<std::string> result;
        for (auto i = begin; i < world_.sent.size(); ++i)
            if (world_.sent[i].topic.starts_with(device))
                result.push_back(world_.sent[i].topic.substr(device.size()) + "=" +
                                 world_.sent[i].payload.substr(0, 5));
        return result;
    }
    ExportWorld world_{1, std::make_shared<Homie>(Homie::Options{})};
};

TEST_F(ExportedToHomie, DescriptionChangesOnlyWhileTheDeviceIsInit) {
    world_.boards["uno1"].values["distance"] = R"({"distance":[42]})";
    start();
    EXPECT_THAT(sent_of("homie/5/uno1/", 0),
                testing::ElementsAre("$state=init", testing::StartsWith("$description={"),
                                     "distance/distance-0=42", "$state=ready"));
    EXPECT_EQ(json::parse(world_.retained["homie/5/asip/$description"])["children"], json::array({"uno1"}));
    EXPECT_EQ(world_.retained["homie/5/asip/$state"], "ready");
    const auto begin = world_.sent.size();
    auto board = homie_board();
    board.name = "Renamed";
    world_.put("uno1", board);
    world_.pass(5s);
    EXPECT_THAT(sent_of("homie/5/uno1/", begin),
                testing::ElementsAre("$state=init", testing::StartsWith("$description={"), "$state=ready"));
}

TEST_F(ExportedToHomie, DeviceThatIsRemoved_EndsWithItsStateFirst_AndIsNoChildAnyMore) {
    world_.boards["uno1"].values["distance"] = R"({"distance":[42]})";
    start();
    const auto begin = world_.sent.size();
    world_.forget("uno1");
    world_.pass(2s);
    EXPECT_THAT(sent_of("homie/5/uno1/", begin),
                testing::ElementsAre("$state=", "distance/distance-0=", "$description="));
    EXPECT_FALSE(json::parse(world_.retained["homie/5/asip/$description"]).contains("children"));
    EXPECT_EQ(json::parse(world_.retained["homie/5/asip/$description"])["version"], 2);
}

TEST_F(ExportedToHomie, TargetIsWhatWasReceived_ThenComesTheValue) {
    auto& gateway = start();
    const std::string servo = "homie/5/uno1/servo/servo-0-angle";
    world_.publish(servo + "/set", "90.0");
    world_.pass(1s);
    ASSERT_EQ(gateway.commands.size(), 1u);
    EXPECT_EQ(world_.retained[servo + "/$target"], "90.0");
    EXPECT_FALSE(world_.retained.contains(servo));
    world_.known("uno1", "servo/0/angle", 90);
    world_.pass(1s);
    EXPECT_EQ(world_.retained[servo], "90");
    // From another sender: the target goes ahead of the value.
    const auto begin = world_.sent.size();
    world_.known("uno1", "servo/0/angle", 45);
    world_.pass(1s);
    EXPECT_THAT(sent_of(servo, begin), testing::ElementsAre("/$target=45", "=45"));
    // One that fails: the target stays another, and the log says why.
    world_.publish(servo + "/set", "10");
    world_.pass(1s);
    gateway.answers.back()("INVALID_DEVICE_NUMBER");
    world_.pass(1s);
    EXPECT_EQ(world_.retained[servo + "/$target"], "10");
    EXPECT_EQ(world_.retained[servo], "45");
    EXPECT_EQ(world_.times_sent("homie/5/uno1/$log/error"), 1u);
    EXPECT_FALSE(world_.retained.contains("homie/5/uno1/$log/error"));
    // A board without its servo leaves neither.
    world_.put("uno1", exported(1, false));
    world_.pass(5s);
    EXPECT_FALSE(world_.retained.contains(servo));
    EXPECT_FALSE(world_.retained.contains(servo + "/$target"));
}

TEST_F(ExportedToHomie, StateIsThatOfTheBoard_AndTheWillThatOfTheGateway) {
    auto& gateway = start();
    world_.boards["uno1"].there = false;
    world_.changed("uno1");
    world_.pass(1s);
    EXPECT_EQ(world_.retained["homie/5/uno1/$state"], "lost");
    world_.kill(gateway);
    EXPECT_EQ(world_.retained["homie/5/asip/$state"], "lost");
    auto& second = world_.start();
    world_.pass(15s);
    EXPECT_EQ(world_.retained["homie/5/asip/$state"], "ready");
    world_.end(second);
    EXPECT_EQ(world_.retained["homie/5/asip/$state"], "disconnected");
}

TEST_F(ExportedToHomie, DevicesOfOthers_AreLeftAlone) {
    world_.publish("homie/5/other/$state", "ready", true);
    world_.publish("homie/5/other/$description", R"({"homie":"5.0","version":1,"root":"hub"})", true);
    world_.publish("homie/5/other/n/p", "1", true);
    world_.publish("homie/5/old/$description", R"({"homie":"5.0","version":3,"root":"asip"})", true);
    world_.publish("homie/5/old/n/p", "1", true);
    auto& gateway = start();
    EXPECT_TRUE(world_.retained.contains("homie/5/other/n/p"));
    EXPECT_FALSE(world_.retained.contains("homie/5/old/n/p")) << "of a board of this bus that is gone";
    EXPECT_FALSE(world_.retained.contains("homie/5/old/$description"));
    world_.publish("homie/5/other/n/p/set", "1");
    world_.pass(1s);
    EXPECT_TRUE(gateway.commands.empty());
    for (const auto& line : gateway.log)
        EXPECT_EQ(line.find("other"), std::string::npos) << line;
}

}  // namespace
}  // namespace asip::gateway::exports
