// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/exhaustive/scenario.hpp"

namespace truth {

namespace {

using Checksum = Plan::Checksum;

Scenario board(std::string name, bool extensions, Checksum checksum = Checksum::kAuto) {
    Scenario scenario;
    scenario.name = std::move(name);
    scenario.plan.extensions = extensions;
    scenario.plan.checksum = checksum;
    scenario.plan.board_pass = 150;
    scenario.plan.idle_pass = 8 * kMillisecond;
    scenario.plan.boot = 30 * kMillisecond;
    scenario.plan.to_host.bunch = kMillisecond;
    return scenario;
}

Scenario ours(std::string name, Checksum checksum = Checksum::kAuto) {
    return board(std::move(name), true, checksum);
}
Scenario of_04(std::string name) {
    return board(std::move(name) + ", ASIP 0.4", false);
}

Command line(unsigned client, std::string text, std::optional<Effect> effect, char answer_tag = 0) {
    Command command;
    command.client = client;
    command.line = std::move(text);
    command.effect = effect;
    command.answer_tag = answer_tag;
    command.lasts = 2 * kSecond;
    return command;
}
Command mark(unsigned client, int number, const std::string& more = {}) {
    return line(client, "W,w," + std::to_string(number) + more, Effect{Effect::Kind::kMark, 0, number});
}
Command distance(unsigned client) {
    return line(client, "D,M", std::nullopt, 'e');
}
Command level(unsigned pin, int value) {
    return line(1, "I,d," + std::to_string(pin) + ',' + std::to_string(value),
                Effect{Effect::Kind::kLevel, pin, value});
}
Command held(unsigned pin, Micros hold) {
    Command command = level(pin, 1);
    command.hold = hold;
    command.safe = "I,d," + std::to_string(pin) + ",0";
    command.lasts = hold;
    return command;
}
Step renewal(Micros after, unsigned client = 1) {
    Step step;
    step.after = after;
    step.command.client = client;
    step.renews = true;
    return step;
}
Command output(unsigned pin) {
    return line(1, "I,P," + std::to_string(pin) + ",3", Effect{Effect::Kind::kMode, pin, 3});
}
Command period(int milliseconds) {
    return line(1, "D,A," + std::to_string(milliseconds), std::nullopt);
}
Command wrong() {
    return line(1, "W,q,1", std::nullopt);
}

Scenario parsed_by_04(Scenario scenario) {
    scenario.name += "'s parser";
    scenario.plan.parser_of_04 = true;
    return scenario;
}

Scenario with(Scenario scenario, std::vector<Step> steps) {
    scenario.steps = std::move(steps);
    return scenario;
}
Scenario from_link_up(Scenario scenario) {
    scenario.from = Scenario::From::kLinkUp;
    return scenario;
}
Scenario stepping_up(Scenario scenario, unsigned max_baud) {
    scenario.from = Scenario::From::kRate;
    scenario.plan.max_baud = max_baud;
    return scenario;
}
Scenario at(unsigned baud, Scenario scenario) {
    scenario.plan.max_baud = baud;
    return scenario;
}
Scenario by_tcp(Scenario scenario) {
    scenario.plan.tcp = true;
    return scenario;
}
Scenario reset_after(Micros time, Scenario scenario) {
    scenario.plan.incidents.push_back({Incident::Kind::kBoardReset, time, 0});
    return scenario;
}

std::vector<Scenario> make() {
    constexpr Micros ms = kMillisecond;
    const std::vector<Step> one = {{0, mark(1, 1)}};
    const std::vector<Step> two_alike = {{0, mark(1, 1)}, {0, mark(1, 2)}};
    const std::vector<Step> two_clients = {{0, mark(1, 1)}, {0, mark(2, 2)}, {1 * ms, level(4, 1)}};
    const std::vector<Step> value = {{0, distance(1)}};
    const std::vector<Step> two_values = {{0, distance(1)}, {3 * ms, distance(2)}};
    const std::vector<Step> reports = {{0, period(60)}, {100 * ms, distance(1)}};
    const std::vector<Step> setting = {{0, output(3)}, {0, mark(1, 1)}};
    const std::vector<Step> error = {{0, wrong()}, {0, mark(1, 1)}};
    const std::vector<Step> reset = {{0, output(3)}, {15 * ms, mark(1, 1)}, {120 * ms, mark(1, 2)}};
    const std::vector<Step> lamp = {{0, output(3)}, {10 * ms, level(3, 1)}, {120 * ms, mark(1, 1)}};
    const std::vector<Step> on_and_off = {{0, level(4, 1)}, {0, level(4, 0)}};
    const std::vector<Step> full = {{0, mark(1, 1, ",abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrst")},
                                    {0, mark(1, 2, ",zyxwvutsrqponm")}};
    const std::vector<Step> read = {{0, line(1, "I,m", std::nullopt, 'm')}, {0, mark(1, 1)}};
    const std::vector<Step> hold = {{0, held(4, 60 * ms)}, renewal(40 * ms)};
    std::vector<Scenario> all = {
        from_link_up(ours("found and identified")),
        from_link_up(of_04("found and identified")),
        stepping_up(ours("line stepping up"), 1'000'000),
        with(ours("command"), one),
        with(ours("command, checksums", Checksum::kAlways), one),
        with(of_04("command"), one),
        with(ours("two commands of one service", Checksum::kNever), two_alike),
        with(ours("two commands of one service, checksums", Checksum::kAlways), two_alike),
        with(of_04("two commands of one service"), two_alike),
        with(ours("two clients"), two_clients),
        with(of_04("two clients"), two_clients),
        with(ours("value"), value),
        with(ours("value, checksums", Checksum::kAlways), value),
        with(of_04("value"), value),
        with(ours("two values"), two_values),
        with(ours("value with reports"), reports),
        with(of_04("value with reports"), reports),
        with(ours("setting"), setting),
        with(of_04("setting"), setting),
        with(ours("error"), error),
        with(of_04("error"), error),
        reset_after(40 * ms, with(ours("reset between"), reset)),
        reset_after(40 * ms, with(of_04("reset between"), reset)),
        reset_after(40 * ms, with(ours("reset of a lamp that is on"), lamp)),
        reset_after(40 * ms, with(of_04("reset of a lamp that is on"), lamp)),
        with(of_04("on and off"), on_and_off),
        with(ours("long lines, checksums", Checksum::kAlways), full),
        at(1'000'000, with(ours("at 1,000,000 baud"), two_clients)),
        by_tcp(with(ours("by TCP"), read)),
        with(ours("hold and renewal"), hold),
        with(ours("hold and renewal, checksums", Checksum::kAlways), hold),
        with(of_04("hold and renewal"), hold),
        from_link_up(parsed_by_04(of_04("found and identified"))),
        with(parsed_by_04(of_04("command")), one),
        with(parsed_by_04(of_04("two commands of one service")), two_alike),
        with(parsed_by_04(of_04("two clients")), two_clients),
        with(parsed_by_04(of_04("value")), value),
        with(parsed_by_04(of_04("value with reports")), reports),
        with(parsed_by_04(of_04("setting")), setting),
        with(parsed_by_04(of_04("error")), error),
        with(parsed_by_04(of_04("hold and renewal")), hold),
    };
    return all;
}

}  // namespace

const std::vector<Scenario>& scenarios() {
    static const std::vector<Scenario> all = make();
    return all;
}

}  // namespace truth
