// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/plan.hpp"

#include <fmt/format.h>

namespace truth {

namespace {

enum class Weather { kCalm, kLight, kMedium, kHeavy };

void damage(WirePlan& wire, double per_byte, Micros active, Dice& dice) {
    wire.damaged = {0, active + 30 * kSecond};
    if (dice.chance(0.5)) {
        wire.damaged.from = dice.between(0, active);
        wire.damaged.until = wire.damaged.from + dice.between(100 * kMillisecond, 3 * kSecond);
    }
    // One kind alone shows best what it does.
    switch (dice.below(6)) {
        case 0:
            wire.lose = per_byte;
            break;
        case 1:
            wire.twice = per_byte;
            break;
        case 2:
            wire.change = per_byte;
            break;
        case 3:
            wire.insert = per_byte;
            break;
        case 4:
            wire.lose_several = per_byte / 8;
            break;
        default:
            wire.lose = wire.twice = wire.change = wire.insert = per_byte / 4;
    }
}

WirePlan draw_wire(Weather weather, Micros active, Dice& dice) {
    WirePlan wire;
    wire.latency = dice.between(0, 3) * 500;
    wire.bunch = dice.chance(0.2) ? 16 * kMillisecond : dice.chance(0.5) ? kMillisecond : 250;
    if (weather == Weather::kCalm) return wire;
    constexpr double kPerByte[] = {0, 1.0 / 2000, 1.0 / 400, 1.0 / 60};
    if (dice.chance(0.7)) damage(wire, kPerByte[static_cast<int>(weather)], active, dice);
    for (auto stalls = dice.below(5); stalls > 2; --stalls) {
        const Micros from = dice.between(0, active);
        const Micros longest = dice.chance(0.3) ? 4 * kSecond : 400 * kMillisecond;
        wire.stalls.push_back({from, from + dice.between(5 * kMillisecond, longest)});
    }
    return wire;
}

ClientPlan draw_client(Dice& dice) {
    ClientPlan client;
    switch (dice.below(4)) {
        case 0:
            client.pause = dice.between(100, 600) * kMillisecond;
            break;
        case 1:
            client.pause = dice.between(20, 80) * kMillisecond;
            break;
        case 2:
            client.pause = dice.between(150, 900) * kMillisecond;
            client.burst = 0.4;
            break;
        default:
            client.pause = dice.between(5, 40) * kMillisecond;
    }
    client.bad = dice.chance(0.5) ? 0.25 : 0;
    client.longs = dice.chance(0.4) ? 0.5 : 0.05;
    client.settings = dice.chance(0.5);
    return client;
}

Incident draw_incident(Micros active, Dice& dice) {
    Incident incident{static_cast<Incident::Kind>(dice.below(6)), dice.between(0, active), 0};
    const bool is_long = dice.chance(0.25);
    incident.lasts = dice.between(20, is_long ? 7000 : 1500) * kMillisecond;
    return incident;
}

}  // namespace

bool Plan::calm() const {
    return incidents.empty() && rate_fails == 0 && !to_board.damages() && !to_host.damages() &&
           to_board.stalls.empty() && to_host.stalls.empty();
}

Plan draw_plan(std::uint64_t seed, Dice& dice) {
    Plan plan;
    plan.seed = seed;
    plan.extensions = dice.chance(0.6);
    plan.checksum = static_cast<Plan::Checksum>(dice.below(3));
    plan.tcp = dice.chance(0.2);
    constexpr unsigned kRates[] = {0, 115'200, 250'000, 1'000'000};
    plan.max_baud = dice.one_of(kRates);
    plan.board_pass = dice.chance(0.1) ? 2 * kMillisecond : dice.between(40, 300);
    plan.boot =
        dice.chance(0.5) ? dice.between(10, 60) * kMillisecond : dice.between(300, 2000) * kMillisecond;
    plan.active = dice.between(1500, 5000) * kMillisecond;
    const auto weather = static_cast<Weather>(dice.below(4));
    plan.to_board = draw_wire(dice.chance(0.2) ? Weather::kCalm : weather, plan.active, dice);
    plan.to_board.bunch = 1;  // its UART is the last part of the way
    plan.to_host = draw_wire(dice.chance(0.2) ? Weather::kCalm : weather, plan.active, dice);
    if (weather != Weather::kCalm) {
        if (dice.chance(0.05)) plan.rate_fails = 0.5;
        if (dice.chance(0.5))
            for (auto count = dice.below(3) + 1; count > 0; --count)
                plan.incidents.push_back(draw_incident(plan.active, dice));
    }
    for (auto count = dice.below(3) + 1; count > 0; --count)
        plan.clients.push_back(draw_client(dice));
    const bool only_marks = dice.chance(0.2);
    for (ClientPlan& client : plan.clients)
        client.only_marks = only_marks;
    return plan;
}

const char* to_string(Incident::Kind kind) {
    switch (kind) {
        case Incident::Kind::kBoardReset:
            return "board reset";
        case Incident::Kind::kUnplug:
            return "unplugged";
        case Incident::Kind::kHang:
            return "board hangs";
        case Incident::Kind::kDie:
            return "board dies";
        case Incident::Kind::kReopen:
            return "port reopened";
        case Incident::Kind::kAgentRestart:
            return "agent restarted";
    }
    return "?";
}

namespace {

std::string describe(const char* name, const WirePlan& wire) {
    std::string text = fmt::format("  {}: latency {} us, bunch {} us", name, wire.latency, wire.bunch);
    if (wire.damages())
        text += fmt::format(
            ", from {:.3f} to {:.3f} s lose {:.5f} lose several {:.5f} twice {:.5f} change {:.5f} insert "
            "{:.5f}",
            wire.damaged.from * 1e-6, wire.damaged.until * 1e-6, wire.lose, wire.lose_several, wire.twice,
            wire.change, wire.insert);
    for (const Span& stall : wire.stalls)
        text += fmt::format(", stalls {:.3f} to {:.3f} s", stall.from * 1e-6, stall.until * 1e-6);
    return text + "\n";
}

}  // namespace

std::string describe(const Plan& plan) {
    constexpr const char* kChecksum[] = {"auto", "always", "never"};
    std::string text = fmt::format(
        "seed {}: board {}, checksum {}, {}, at most {} baud, pass {} us, boot {:.3f} s, {} clients, active "
        "{:.3f} s\n",
        plan.seed, plan.extensions ? "with extensions" : "of 0.4", kChecksum[static_cast<int>(plan.checksum)],
        plan.tcp ? "tcp" : "serial", plan.max_baud, plan.board_pass, plan.boot * 1e-6, plan.clients.size(),
        plan.active * 1e-6);
    text += describe("to the board", plan.to_board);
    text += describe("to the host", plan.to_host);
    for (const Incident& incident : plan.incidents)
        text += fmt::format("  {:.3f} s: {}, {:.3f} s\n", incident.at * 1e-6, to_string(incident.kind),
                            incident.lasts * 1e-6);
    return text;
}

}  // namespace truth
