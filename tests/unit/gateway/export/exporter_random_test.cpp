// SPDX-License-Identifier: Apache-2.0
// No ghosts, whatever happened: random sequences of crashes, restarts, renames and options. ASIP_HISTORIES
// says how many in tens.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "export_world.hpp"
#include "gateway/export/homie.hpp"

namespace asip::gateway::exports {
namespace {

constexpr unsigned kTens = 50;
constexpr int kSteps = 30;

/// What must be retained for the boards that are there, and nothing else.
std::map<std::string, std::set<std::string>> wanted_devices(const ExportWorld& world,
                                                            const HomeAssistant& dialect) {
    std::map<std::string, std::set<std::string>> result{
        {dialect.gateway_document_topic(), {"binary_sensor connection", "sensor boards"}}};
    for (const auto& [name, board] : world.boards) {
        auto& device = result[dialect.document_topic(name)];
        for (const auto& [id, platform] : dialect.components(board.board))
            device.insert(platform + " " + id);
    }
    return result;
}

/// A dialect at its usual place, or elsewhere.
using MakeDialect = std::shared_ptr<const Dialect> (*)(bool elsewhere, bool read_only);

class RandomHistory {
  public:
    RandomHistory(unsigned seed, MakeDialect make)
        : random_(seed), make_(make), world_(seed, make(false, false)) {}

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
        const bool read_only = pick(4) == 0;
        options.dialect = make_(pick(6) == 0, read_only);
        world_.start(options);
    }
    /// Where nobody exports, nobody knows afterwards whose the rest is.
    void empty_some() {
        if (std::none_of(world_.gateways.begin(), world_.gateways.end(),
                         [](const auto& each) { return each->alive && each->exporter->active(); }))
            return;
        for (const auto& [topic, payload] : std::map(world_.retained))
            if (pick(3) == 0) world_.publish(topic, "", true);
        world_.room = 1000;
        world_.pass(1s);
    }
    void act() {
        const auto board = name();
        switch (pick(11)) {
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
                return empty_some();
            case 8:
                if (world_.boards.contains(board))
                    world_.value(board, "distance", "{\"distance\":[" + std::to_string(pick(9)) + ",1,2]}");
                return;
            default: {
                // In this order by every compiler, so that a seed is one history.
                const auto servos = static_cast<int>(pick(4));
                const bool pin = pick(2) == 0;
                return world_.put(board, exported(servos, pin, "N" + std::to_string(pick(3))));
            }
        }
    }

    std::mt19937 random_;
    MakeDialect make_;
    ExportWorld world_;
};

std::shared_ptr<const Dialect> home_assistant(bool elsewhere, bool read_only) {
    return ExportWorld::home_assistant(elsewhere ? "elsewhere" : "homeassistant", read_only);
}
std::shared_ptr<const Dialect> homie(bool elsewhere, bool read_only) {
    Homie::Options options;
    options.read_only = read_only;
    if (elsewhere) options.domain = "elsewhere";
    return std::make_shared<Homie>(options);
}

/// What is retained, without which gateway exports and how often a document changed.
std::map<std::string, std::string> settled(const ExportWorld& world, const Dialect& dialect) {
    auto result = world.retained;
    result.erase(dialect.lease());
    for (auto& [topic, payload] : result) {
        auto document = nlohmann::json::parse(payload, nullptr, false);
        if (!document.is_object() || document.erase("version") == 0) continue;
        payload = document.dump();
    }
    return result;
}

/// What is said to be unknown, since there was a value before, is as good as what was never said.
void leave_out_unknown(std::map<std::string, std::string>& retained, const ExportWorld& world,
                       const Dialect& dialect) {
    for (const auto& [name, board] : world.boards) {
        for (const auto& property : board.board.properties) {
            const auto found = retained.find(dialect.state(name, property));
            if (found != retained.end() && found->second == dialect.state_text(property, nullptr))
                retained.erase(found);
        }
    }
}

unsigned sequences() {
    const char* const wanted = std::getenv("ASIP_HISTORIES");
    return 10 * (wanted == nullptr ? kTens : static_cast<unsigned>(std::strtoul(wanted, nullptr, 10)));
}

class ExporterHistory : public testing::TestWithParam<MakeDialect> {};

/// Home Assistant alone remembers what no document names any more.
void expect_devices(ExportWorld& world) {
    for (auto& [topic, device] : world.devices)
        ASSERT_TRUE(topic_matches("homeassistant/device/+/config", topic)) << topic;
    // Entities are there by what is retained, as after its restart.
    world.restart_home_assistant();
    world.pass(5s);
    ASSERT_EQ(world.devices, wanted_devices(world, HomeAssistant({})));
}

TEST_P(ExporterHistory, AfterAnyHistory_AsMuchIsRetainedAsAfterNone) {
    const auto dialect = GetParam()(false, false);
    const bool home = dialect->by() == "home-assistant";
    ASSERT_GT(sequences(), 0u);
    for (unsigned seed = 1; seed <= sequences(); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        RandomHistory history(seed, GetParam());
        history.run();
        history.settle(true);
        auto& world = history.world();
        if (home) expect_devices(world);
        if (HasFatalFailure()) return;
        ExportWorld fresh(seed, dialect);
        fresh.boards = world.boards;
        fresh.start();
        fresh.pass(10s);
        auto retained = settled(world, *dialect);
        leave_out_unknown(retained, world, *dialect);
        const auto expected = settled(fresh, *dialect);
        ASSERT_EQ(retained, expected);
        ASSERT_EQ(world.retained[dialect->gateway_state()], dialect->online());
        history.settle(false);
        ASSERT_TRUE(world.retained.empty()) << world.retained.begin()->first;
    }
}

INSTANTIATE_TEST_SUITE_P(Each, ExporterHistory, testing::Values(&home_assistant, &homie));

}  // namespace
}  // namespace asip::gateway::exports
