// SPDX-License-Identifier: Apache-2.0
// Commands whose weight is beside their payload: no row of tests/shares has them. Each program stays alive
// below the memory limit of its systemd unit, and a stop goes through meanwhile.
#include <atomic>
#include <fstream>
#include <thread>

#include "tests/integration/secure/running_bus.hpp"
#include "tests/support/patterns.hpp"

namespace asip::test {
namespace {

constexpr std::size_t kMegabyte = std::size_t{1} << 20;

std::size_t memory_max_of(const std::string& unit) {
    std::ifstream file(ASIP_TEST_PACKAGING "/systemd/" + unit);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto found = first_match(text, "\nMemoryMax=([0-9]+)([MG])\n");
    if (!found) throw std::runtime_error(unit + " has no MemoryMax");
    return std::stoul(found->at(1)) * kMegabyte * (found->at(2) == "G" ? 1024 : 1);
}

std::size_t peak_bytes(const ChildProcess& program) {
    std::ifstream status("/proc/" + std::to_string(program.pid()) + "/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stoul(line.substr(6)) * 1024;
    return 0;
}

/// For how long a program was ready to run, and others had the processor.
std::chrono::nanoseconds waited_for_a_processor(const ChildProcess& program) {
    std::ifstream file("/proc/" + std::to_string(program.pid()) + "/schedstat");
    std::int64_t ran = 0, waited = 0;
    file >> ran >> waited;
    return std::chrono::nanoseconds(waited);
}

class WorstOfEachKind : public RunningBus {
  protected:
    WorstOfEachKind() {
        add({"operator", "eve"});
        // The broker that runs is told of it by its pid file.
        if (!wait_until([this] { return may_publish("eve", "asip/nobody/in"); }))
            throw std::runtime_error("eve");
    }

    /// Sends the attack in a thread again and again, for as long as it takes to answer kStops stops of an
    /// operator. On a machine that does other things, too, the time does not count for which
    /// broker and agent had to wait for a processor.
    void flood(const mqtt::Message& command, int times) {
        std::atomic<int> answered_meanwhile{0};
        std::atomic<bool> under_way{true}, begun{false};
        std::thread attacker([&] {
            auto probe = this->probe("eve", {});
            for (int i = 0; i < times || answered_meanwhile < kStops; ++i) {
                if (HasFailure()) break;
                // A broker that has enough of an attacker throws it out: it comes again.
                wait_until([&] { return probe.connected(); }, 20s);
                probe.publish(command);
                begun = true;
                // What waits in the attacker's own memory is sent to no client.
                if (i % kAtOnce == kAtOnce - 1)
                    wait_until([&] { return probe.all_acknowledged() || !probe.connected(); }, 20s);
            }
            wait_until([&] { return probe.all_acknowledged() || !probe.connected(); }, 20s);
            under_way = false;
        });
        EXPECT_TRUE(wait_until([&] { return begun.load(); }));
        auto ann = probe("ann", {"asip/reply/ann/uno/stop"});
        int stops = 0;
        do {
            const auto begin = std::chrono::steady_clock::now();
            const auto waited = waited_for_a_processor(*broker_) + waited_for_a_processor(*agent_);
            mqtt::Message stop{.topic = "asip/uno/$stop",
                               .qos = 1,
                               .response_topic = "asip/reply/ann/uno/stop",
                               .correlation = "stop-" + std::to_string(++stops)};
            ann.publish(stop);
            const auto answered = ann.wait_for(
                [&](const mqtt::Message& message) { return message.correlation == stop.correlation; });
            const auto others = waited_for_a_processor(*broker_) + waited_for_a_processor(*agent_) - waited;
            const auto took = std::chrono::steady_clock::now() - begin - others;
            EXPECT_TRUE(answered) << "stop " << stops << " was never answered; " << agent_->errors();
            EXPECT_LT(took, 1s) << "stop " << stops;
            longest_ = std::max(longest_, took);
            if (under_way) ++answered_meanwhile;
        } while (under_way && !HasFailure());
        attacker.join();
        EXPECT_GE(answered_meanwhile, kStops) << "stops while each attack was under way";
        stops_ += stops;
    }
    void expect_all_alive() {
        for (const auto& [program, unit] : {std::pair{agent_.get(), "asip-agent@.service"},
                                            {registry_.get(), "asip-registry.service"},
                                            {gateway_.get(), "asip-gateway.service"}}) {
            EXPECT_TRUE(program->running()) << unit << program->errors();
            EXPECT_LT(peak_bytes(*program), memory_limit(memory_max_of(unit))) << unit;
            RecordProperty(std::string(unit) + ".peak_bytes", std::to_string(peak_bytes(*program)));
        }
        RecordProperty("stops", stops_);
        RecordProperty(
            "longest_stop_ms",
            static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(longest_).count()));
        // Behind commands of the flood that still wait, in turn.
        EXPECT_TRUE(wait_until([&] { return agent_answers(); })) << agent_->errors();
        // A board whose credential is used for the flood may be online, too.
        EXPECT_EQ(asipctl("bob", {"list", "--board", "uno", "--state", "online", "-o", "name"}).output,
                  "uno\n")
            << registry_->errors();
        EXPECT_TRUE(wait_until([&] { return gateway_commands(); })) << gateway_->errors();
    }
    static mqtt::Message message(const std::string& topic, std::string payload = {}) {
        return mqtt::Message{.topic = topic, .payload = std::move(payload), .qos = 1};
    }

    static constexpr int kStops = 20, kAtOnce = 50;
    std::chrono::steady_clock::duration longest_{};
    int stops_ = 0;
};

TEST_F(WorstOfEachKind, CommandsThatAreMostlyProperties) {
    auto command = message("asip/uno/in", R"({"raw":"I,d,13,1"})");
    for (int i = 0; i < 3; ++i)  // the broker takes 256 KiB
        command.user_properties.emplace_back("junk", std::string(65000, 'x'));
    flood(command, 750);
    expect_all_alive();
}

TEST_F(WorstOfEachKind, CommandsWithLongTopicsForAnswersAndLongCorrelations) {
    auto command = message("asip/uno/io/in", R"({"write":[13,1]})");
    command.response_topic = "asip/reply/eve/uno/" + std::string(60000, 'x');
    command.correlation = std::string(60000, 'y');
    flood(command, 800);
    expect_all_alive();
}

}  // namespace
}  // namespace asip::test
