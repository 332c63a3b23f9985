// SPDX-License-Identifier: Apache-2.0
// No ghosts, whatever happened: random sequences of crashes, restarts, renames and options.
#include <gtest/gtest.h>

#include <random>

#include "export_world.hpp"

namespace asip::gateway::exports {
namespace {

constexpr int kSequences = 500;
constexpr int kSteps = 30;

/// What must be retained for the boards that are there, and nothing else.
std::map<std::string, std::set<std::string>> wanted_devices(const ExportWorld& world,
                                                            const HomeAssistant& dialect) {
    std::map<std::string, std::set<std::string>> result;
    for (const auto& [name, board] : world.boards) {
        auto& device = result[dialect.document_topic(name)];
        for (const auto& [id, platform] : dialect.components(board.board))
            device.insert(platform + " " + id);
    }
    return result;
}

class RandomHistory {
  public:
    explicit RandomHistory(unsigned seed) : random_(seed), world_(seed) {}

    void run() {
        for (int step = 0; step < kSteps; ++step) {
            act();
            world_.room = pick(3) == 0 ? 1 + pick(5) : 1000;
            for (auto steps = pick(40); steps > 0; --steps)
                world_.step();
        }
    }
    void settle(bool enabled) {
        world_.room = 1000;
        for (auto& gateway : world_.gateways)
            world_.kill(*gateway);
        auto options = world_.options();
        options.enabled = enabled;
        world_.start(options);
        world_.pass(40s);
    }
    ExportWorld& world() { return world_; }

  private:
    std::size_t pick(std::size_t below) { return random_() % below; }
    std::string name() { return "uno" + std::to_string(pick(4)); }

    void start() {
        if (world_.gateways.size() > 12) return;
        auto options = world_.options();
        options.enabled = pick(4) != 0;
        options.dialect.read_only = pick(4) == 0;
        if (pick(6) == 0) options.dialect.prefix = "elsewhere";
        world_.start(options);
    }
    void act() {
        const auto board = name();
        switch (pick(10)) {
            case 0:
            case 1:
                return start();
            case 2:
                if (!world_.gateways.empty()) world_.kill(*world_.gateways[pick(world_.gateways.size())]);
                return;
            case 3:
                if (!world_.gateways.empty()) {
                    auto& gateway = *world_.gateways[pick(world_.gateways.size())];
                    if (gateway.alive) world_.end(gateway);
                }
                return;
            case 4:
                return world_.restart_broker(pick(3) != 0);
            case 5:
                if (world_.boards.contains(board)) world_.forget(board);
                return;
            case 6:
                return world_.restart_home_assistant();
            case 7:
                if (world_.boards.contains(board))
                    world_.value(board, "distance", "{\"distance\":[" + std::to_string(pick(9)) + ",1,2]}");
                return;
            default:
                return world_.put(
                    board, exported(static_cast<int>(pick(4)), pick(2) == 0, "N" + std::to_string(pick(3))));
        }
    }

    std::mt19937 random_;
    ExportWorld world_;
};

TEST(ExporterHistory, AfterAnyHistory_NothingIsRetainedThatShouldNotBe) {
    for (unsigned seed = 1; seed <= kSequences; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        RandomHistory history(seed);
        history.run();
        history.settle(true);
        auto& world = history.world();
        const HomeAssistant dialect({});
        for (auto& [topic, device] : world.devices)
            ASSERT_TRUE(topic_matches("homeassistant/device/+/config", topic)) << topic;
        // Entities are there by what is retained, as after a restart of Home Assistant.
        world.restart_home_assistant();
        world.pass(5s);
        ASSERT_EQ(world.devices, wanted_devices(world, dialect));
        std::set<std::string> allowed{dialect.lease(), dialect.gateway_state()};
        for (const auto& [name, board] : world.boards) {
            allowed.insert(dialect.document_topic(name));
            allowed.insert(dialect.board_state(name));
            for (const auto& [id, platform] : dialect.components(board.board))
                allowed.insert(dialect.state(name, id));
        }
        for (const auto& [topic, payload] : world.retained)
            ASSERT_TRUE(allowed.contains(topic)) << topic;
        ASSERT_EQ(world.retained[dialect.gateway_state()], "online");
        history.settle(false);
        ASSERT_TRUE(world.retained.empty()) << world.retained.begin()->first;
    }
}

}  // namespace
}  // namespace asip::gateway::exports
