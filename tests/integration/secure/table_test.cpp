// SPDX-License-Identifier: Apache-2.0
// Each cell of the table in SECURITY.md, tried at a running broker as a user of that role.
#include <gmock/gmock.h>

#include "cli/secure/leftovers.hpp"
#include "cli/secure/topic_rules.hpp"
#include "cli/secure/try_out.hpp"
#include "tests/integration/secure/secured_bus.hpp"

namespace asip::test {
namespace {

using cli::Role;
using cli::RoleOfUser;

/// `topic` of a rule with names in place of its levels USER, BOARD and so on.
std::string with_names(const cli::TopicRule& rule, const std::string& user, const std::string& board) {
    auto topic = "/" + rule.topic + "/";
    for (const auto& [level, name] : {std::pair<std::string, std::string>{"USER", user},
                                      {"BOARD", board},
                                      {"SERVICE", "io"},
                                      {"CLIENT", "c1"},
                                      {"PART", "p1"},
                                      {"EXPORTED", "uno2"},
                                      {"NAME", "n1"},
                                      {"ID", "hall"}}) {
        const auto at = topic.find("/" + level + "/");
        if (at != std::string::npos) topic.replace(at + 1, level.size(), name);
    }
    return rule.outside ? topic.substr(1, topic.size() - 2) : "asip" + topic.substr(0, topic.size() - 1);
}

class TableOfRules : public SecuredBus {
  protected:
    TableOfRules() {
        add({"board", "uno1"});
        add({"operator", "ann"});
        add({"viewer", "bob"});
        add({"registry"});
        add({"gateway"});
        add({"home-assistant"});
        start_broker();
    }

    mqtt::Options options(const std::string& user) const {
        const auto kept = cli::SecureFolder::open(folder());
        if (!kept) throw std::runtime_error(kept.error().text);
        auto made = cli::options_of(*kept, user);
        if (!made) throw std::runtime_error(made.error().text);
        return *made;
    }
    void try_all(const RoleOfUser& user) {
        std::vector<cli::Trial> trials;
        Words boards{user.name, "uno2", "registry"};
        if (user.boards) boards.insert(boards.end(), user.boards->begin(), user.boards->end());
        for (const auto& rule : cli::topic_rules()) {
            for (const auto& asker : {user.name, std::string("carol")}) {
                for (const auto& board : boards) {
                    // No person may be taken for a board of its name: see below.
                    const bool person = user.role != Role::kBoard && user.role != Role::kRegistry;
                    if (person && board == user.name) continue;
                    // No board is called so: only in answers it stands for registries.
                    if (board == "registry" && !rule.topic.starts_with("reply/")) continue;
                    const auto topic = with_names(rule, asker, board);
                    const auto below = rule.outside ? topic : topic.substr(5);
                    trials.push_back(
                        {user.name, "write " + topic, cli::may_write(rule, user, below), {topic}, {}});
                    trials.push_back(
                        {user.name, "read " + topic, cli::may_read(rule, user, below), {}, {topic}});
                }
            }
        }
        expect(trials);
    }
    void expect(const std::vector<cli::Trial>& trials) {
        ASSERT_GT(trials.size(), 0U);
        const auto found =
            cli::try_out(trials, options(trials.front().user), options("admin"), "asip", kDeadline);
        ASSERT_TRUE(found) << found.error().text;
        for (std::size_t i = 0; i < trials.size(); ++i)
            EXPECT_EQ((*found)[i], trials[i].allowed ? cli::Found::kAllowed : cli::Found::kDenied)
                << trials[i].user << ": " << trials[i].what;
    }
};

TEST_F(TableOfRules, Board) {
    try_all({"uno1", Role::kBoard});
}
TEST_F(TableOfRules, Viewer) {
    try_all({"bob", Role::kViewer});
}
TEST_F(TableOfRules, Operator) {
    try_all({"ann", Role::kOperator});
}
TEST_F(TableOfRules, OperatorOfSomeBoards) {
    announce("uno1", R"({"class":"4b"})");
    ASSERT_EQ(secure(Words{"add", "operator", "eve", "-l", "class=4b"} + reload()).status, 0);
    ASSERT_TRUE(wait_until([&] { return may_publish("eve", "asip/uno1/$stop"); }));
    try_all({"eve", Role::kOperator, {{"uno1"}}});
}
TEST_F(TableOfRules, Registry) {
    try_all({"registry", Role::kRegistry});
}
TEST_F(TableOfRules, Gateway) {
    try_all({"gateway", Role::kGateway});
}
TEST_F(TableOfRules, HomeAssistant) {
    try_all({"home-assistant", Role::kHomeAssistant});
}
TEST_F(TableOfRules, Admin) {
    try_all({"admin", Role::kAdmin});
}

TEST_F(TableOfRules, TopicsThatAreInNoRow_AreDeniedToEverybody) {
    for (const char* user : {"uno1", "bob", "ann", "gateway", "home-assistant", "registry"}) {
        std::vector<cli::Trial> trials;
        const std::string name = user;
        for (const auto& topic :
             std::vector<std::string>{"asip/servicebus/" + name + "/$junk",
                                      "asip/servicebus/" + name + "/$state/x",
                                      "asip/servicebus/" + name + "/$demand/" + name + "/c1/x",
                                      "asip/servicebus/uno2/$demand/" + name,
                                      "asip/servicebus/uno2/$demand/" + name + "/c1/x",
                                      "asip/" + name + "/out/x",
                                      "asip/" + name + "/a/b/out",
                                      "asip/reply/" + name + "/$self/c1/p1/x",
                                      "asip/reply/" + name + "/uno2/c1",
                                      "asip/reply/" + name,
                                      "asip/reply/carol/" + name,
                                      "asip/reply/carol/" + name + "/c1/p1/x",
                                      "asip/servicebus/$probe/x",
                                      "asip/registry/query/x",
                                      "asip/registry/hall/$junk",
                                      "asip",
                                      "asip/junk",
                                      "asip/export",
                                      "asip/export/ha",
                                      "asip/export/dashboard",
                                      "asip/export/dashboard/n1/x",
                                      "asip/export/other/x",
                                      "asip/export/ha/in",
                                      "asip/export/in",
                                      "asip/export/$stop",
                                      "asip/servicebus/in",
                                      "asip/servicebus/$stop",
                                      "asip/servicebus/uno2/in",
                                      "asip/servicebus/uno2/junk",
                                      "asip/servicebus/uno2/junk/junk",
                                      "asip/registry/in",
                                      "asip/registry/$stop",
                                      "asip/registry/hall/in",
                                      "asip/reply/in",
                                      "asip/reply/$stop",
                                      "asip/reply/carol/in",
                                      "homeassistant/" + name,
                                      "homeassistant/sensor/x/config",
                                      "homie/4/" + name,
                                      "homie/5",
                                      "spBv1.0/hall/" + name,
                                      "spBv1.0/hall/DDATA/" + name,
                                      "spBv1.0/hall/DOTHER/n1/uno2",
                                      "spBv1.0/STATE",
                                      "elsewhere",
                                      "elsewhere/" + name})
            trials.push_back({name, "write " + topic, false, {topic}, {}});
        // A registry clears whatever stands in place of a board.
        if (name == "registry")
            std::erase_if(trials, [](const auto& trial) {
                return trial.what == "write asip/servicebus/in" ||
                       trial.what == "write asip/servicebus/$stop";
            });
        expect(trials);
    }
}

TEST_F(TableOfRules, PersonIsNotTakenForABoardOfItsName) {
    for (const auto& user : {RoleOfUser{"bob", Role::kViewer}, RoleOfUser{"ann", Role::kOperator},
                             RoleOfUser{"gateway", Role::kGateway}}) {
        std::vector<cli::Trial> trials;
        for (const auto& rule : cli::topic_rules()) {
            if (rule.topic.find("BOARD") == std::string::npos) continue;
            const auto topic = with_names(rule, "carol", user.name);
            trials.push_back({user.name, "write " + topic, false, {topic}, {}});
        }
        expect(trials);
    }
}

}  // namespace
}  // namespace asip::test
