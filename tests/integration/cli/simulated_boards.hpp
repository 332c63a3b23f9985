// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <csignal>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {

/// Boards in one simulator, each with an agent of its own: `desk` with two servos, `old`, a board of ASIP 0.4
/// with two servos, and `lamp`, which has its pins alone.
class SimulatedBoards : public BusTest {
  protected:
    void start(const std::vector<std::string>& names) {
        Words words{ASIP_PROGRAMS "/asip-sim", "--socket", folder_.file("sim.sock")};
        for (const auto& name : names)
            words.push_back(folder_.write(name + ".json", nlohmann::json{{"name", name},
                                                                         {"board", "uno"},
                                                                         {"image", image(kImages.at(name))},
                                                                         {"link", folder_.file(name)}}
                                                              .dump()));
        sim_ = std::make_unique<ChildProcess>(words);
        for (const auto& name : names)
            ASSERT_TRUE(sim_->wait_for_output(name + " .*port")) << sim_->errors();
        for (const auto& name : names)
            start_agent(name);
        for (const auto& name : names)
            ASSERT_TRUE(wait_state(name, "online") && wait_described(name)) << agents_[name]->errors();
    }

    void start_agent(const std::string& name, const Words& more = {}) {
        Words words{
            ASIP_PROGRAMS "/asip-agent", "--serial", folder_.file(name), "--name", name, "--state-dir",
            folder_.file("state")};
        words.insert(words.end(), more.begin(), more.end());
        agents_[name] = std::make_unique<ChildProcess>(words, environment());
    }

    static std::string image(const std::string& name) { return ASIP_IMAGES "/" + name + ".elf"; }

    bool wait_state(const std::string& board, const std::string& state) {
        return wait_until([&] { return probe_.last("asip/servicebus/" + board + "/$state") == state; });
    }

    /// An agent announces the state first.
    bool wait_described(const std::string& board) {
        return wait_until(
            [&] { return probe_.last("asip/servicebus/" + board + "/$description").has_value(); });
    }

    void kill_agent(const std::string& board) {
        agents_[board]->signal(SIGKILL);
        agents_[board]->wait_exit();
        ASSERT_TRUE(wait_state(board, "lost"));
    }

    const std::map<std::string, std::string> kImages{
        {"desk", "asip_uno_services"}, {"old", "asip_uno_04_services"}, {"lamp", "asip_uno"}};
    TempDir folder_;
    std::unique_ptr<ChildProcess> sim_;
    std::map<std::string, std::unique_ptr<ChildProcess>> agents_;
};

}  // namespace asip::test
