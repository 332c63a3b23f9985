// SPDX-License-Identifier: Apache-2.0
// The bus under faults: an engine, registries, agents, clients and watchers, which are killed and stopped.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "tests/cluster/fleet.hpp"
#include "tests/cluster/judge.hpp"

namespace {

using namespace cluster;

struct Settings {
    std::string engine = "mosquitto";
    std::size_t rounds = 0;
    std::size_t skip = 0;
    std::uint64_t seed = 1;
    std::string faults = "all";
    std::string logs = "cluster-logs";
    FleetOptions fleet;
};

std::string described(const std::vector<Fault>& faults) {
    std::string text;
    for (const auto& fault : faults)
        text += fmt::format("{}{} {} at {} ms for {} ms", text.empty() ? "" : ", ", name_of(fault),
                            fault.index, fault.after, fault.lasts);
    return text;
}

std::unique_ptr<Network> make_network(const Settings& settings) {
    if (settings.faults == "processes") return nullptr;
    const auto why = Network::impossible();
    if (why.empty()) return std::make_unique<Network>(Fleet::hosts(settings.fleet));
    if (settings.faults == "network") throw std::runtime_error(why);
    fmt::print("LEFT OUT: faults of the network; {}\n", why);
    return nullptr;
}

std::string seconds(const std::optional<Millis>& time) {
    return time ? fmt::format("{:.3f} s", static_cast<double>(*time) / 1000) : "never";
}

/// How, and by how much a busy machine may have had a part in it.
std::string came_back(const Round& round, const History& history) {
    const auto since = [&](const std::optional<Millis>& at) {
        return seconds(at ? std::optional(*at - round.end) : std::nullopt);
    };
    return fmt::format("engine {}, commands {}{}, catalogues {}; longest delay of the harness {} ms",
                       since(round.engine_works), since(round.commands_work),
                       round.commands_work ? "" : " to" + names_of_mute(round, history),
                       since(round.catalogues_agree), round.delayed);
}

int run(Settings settings) {
    fmt::print("engine {}, seed {}, {} boards ({} with real firmware), {} registries, {} clients\n",
               settings.engine, settings.seed, settings.fleet.boards,
               std::min(settings.fleet.boards, settings.fleet.firmware), settings.fleet.registries,
               settings.fleet.clients);
    History history;
    boost::asio::io_context io;
    const auto network = make_network(settings);
    settings.fleet.clock = settings.faults == "all";
    if (settings.faults == "network") settings.fleet.processes = false;
    const auto engine = make_engine(settings.engine, Hosts{network.get()});
    for (const auto& lack : engine->lacks())
        fmt::print("{}: {}\n", engine->name(), lack);
    const truth::Machine machine;
    Fleet fleet(io, *engine, network.get(), settings.fleet, machine, history);
    try {
        fleet.set_up();
    } catch (const std::runtime_error& error) {
        fleet.write_logs(settings.logs);
        fmt::print("not begun: {}; logs are in {}\n", error.what(), settings.logs);
        return 1;
    }
    if (!settings.fleet.only.empty() && !is_known(settings.fleet.only, fleet.shape()))
        throw std::runtime_error("there is no fault \"" + settings.fleet.only + "\" here");
    auto plan = settings.rounds == 0 ? each_once(settings.seed, fleet.shape())
                                     : at_random(settings.seed, settings.rounds, fleet.shape());
    plan.erase(plan.begin(),
               plan.begin() + static_cast<std::ptrdiff_t>(std::min(settings.skip, plan.size())));
    for (const auto& faults : plan) {
        fmt::print("{:8.3f} s: {}\n", static_cast<double>(now()) / 1000, described(faults));
        std::fflush(stdout);
        fleet.suffer(faults);
        const auto& round = history.rounds.back();
        fmt::print("            {}\n", came_back(round, history));
        if (!round.commands_work || !round.catalogues_agree) fleet.write_logs(settings.logs);
    }
    fleet.finish();
    const auto verdict = judge(history, machine.pace());
    fmt::print("\n{}\n{} commands, {} violations, seed {}\n", report(engine->name(), verdict),
               history.commands.size(), verdict.violations.size(), settings.seed);
    const bool wrong = !verdict.violations.empty();
    if (wrong || settings.fleet.log_level != "info") {
        fleet.write_logs(settings.logs);
        fmt::print("logs are in {}\n", settings.logs);
    }
    return wrong ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app("Kills and stops the parts of a bus and checks that commands and catalogues stay true.");
    app.add_option("engine", settings.engine, "MQTT engine")
        ->check(CLI::IsMember(engine_names()))
        ->capture_default_str();
    app.add_option("--rounds", settings.rounds,
                   "Faults and pairs of them at random; default: each fault once");
    app.add_option("--skip", settings.skip,
                   "Leave out so many of the first rounds: to see a later one again");
    app.add_option("--faults", settings.faults,
                   "processes: killed and stopped; network: packets dropped and delayed between hosts, which "
                   "only root can make; all: both, and a clock that is stepped")
        ->check(CLI::IsMember({"all", "processes", "network"}))
        ->capture_default_str();
    app.add_option("--seed", settings.seed, "Decides the faults")->capture_default_str();
    app.add_option("--agents", settings.fleet.boards, "Boards")
        ->check(CLI::Range(1, 200))
        ->capture_default_str();
    app.add_option("--firmware", settings.fleet.firmware,
                   "So many of the boards are real firmware in a simulator; the others are scripted")
        ->check(CLI::Range(0, 200))
        ->capture_default_str();
    app.add_option("--registries", settings.fleet.registries)->check(CLI::Range(1, 9))->capture_default_str();
    app.add_option("--clients", settings.fleet.clients, "That send commands")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    app.add_option("--longest", settings.fleet.longest_stop,
                   "Milliseconds that faults at random last at the most, but for those that kill")
        ->check(CLI::Range(5'000, 60'000))
        ->capture_default_str();
    app.add_option("--only", settings.fleet.only,
                   "At random only this fault, alone, by its name in the table: \"broker cut\"");
    app.add_option("--log-level", settings.fleet.log_level,
                   "Of agents and registries; above info logs are kept also without a violation")
        ->check(CLI::IsMember({"info", "debug", "trace"}))
        ->capture_default_str();
    app.add_option("--logs", settings.logs, "Folder for the programs' logs after a violation")
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        return run(settings);
    } catch (const std::exception& error) {
        fmt::print(stderr, "cluster: {}\n", error.what());
        return 2;
    }
}
