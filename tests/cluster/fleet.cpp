// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/fleet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/cluster/firmware_board.hpp"
#include "tests/cluster/tcp_board.hpp"
#include "tests/support/loop.hpp"

namespace cluster {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t kDeparting = 2;
constexpr auto kSetUp = 60s;

}  // namespace

Fleet::Fleet(boost::asio::io_context& io, Engine& engine, Network* network, const FleetOptions& options,
             const truth::Machine& machine, History& history)
    : io_(io),
      engine_(engine),
      hosts_{network},
      network_(network),
      options_(options),
      machine_(machine),
      history_(history) {
    folder_.write("clock", std::string(sizeof(std::int64_t), '\0'));
    for (std::size_t i = 0; i < options_.registries; ++i) {
        const auto id = fmt::format("r{}", i);
        registries_.push_back(start(host_of_registry(i), i == 0, program("asip-registry", i, {"--id", id})));
        watchers_.push_back(
            std::make_unique<Watcher>(io_, connection("watch-" + id, i), id, truth_, history_));
    }
    for (std::size_t i = 0; i < options_.boards + kDeparting; ++i) {
        const bool stays = i < options_.boards;
        const auto name = stays ? fmt::format("board{:03}", i) : fmt::format("left{}", i - options_.boards);
        history_.boards.push_back(name);
        truth_.online.insert(name);
        boards_.push_back(make_board(i));
        auto link = boards_.back()->link();
        link.insert(link.end(), {"--name", name});
        agents_.push_back(
            start(host_of_share(i % kShares), i % kShares == 0, program("asip-agent", i, link)));
    }
    const double each =
        options_.per_board * static_cast<double>(options_.boards) / static_cast<double>(options_.clients);
    for (std::size_t i = 0; i < options_.clients; ++i)
        commanders_.push_back(std::make_unique<Commander>(
            io_, connection(fmt::format("commands-{}", i), i), history_,
            Commander::Load{.boards = options_.boards,
                            .first = i * options_.boards / options_.clients,
                            .per_second = each,
                            .request = [this](std::size_t board,
                                              std::size_t token) { return boards_[board]->request(token); },
                            .qos = static_cast<int>(i % 2)}));
    for (std::size_t i = 0; i < engine_.brokers().size(); ++i)
        echoes_.push_back(std::make_unique<Echo>(io_, echo(i), i, engine_.brokers().size()));
}

std::unique_ptr<Board> Fleet::make_board(std::size_t index) {
    const auto executed = [this, index](std::size_t token, Millis at) {
        history_.executions.push_back({token, index, at});
    };
    if (index < options_.firmware)
        return std::make_unique<FirmwareBoard>(io_, history_.boards[index], executed);
    return std::make_unique<TcpBoard>(io_, history_.boards[index], hosts_.address(Network::kWired), executed);
}

Shape Fleet::shape() const {
    return {.nodes = engine_.nodes(),
            .registries = options_.registries,
            .boards = options_.boards,
            .shares = network_ != nullptr ? std::min(kShares, options_.boards) : 0,
            .clock = options_.clock,
            .processes = options_.processes,
            .longest_stop = options_.longest_stop,
            .only = options_.only};
}

std::size_t Fleet::hosts(const FleetOptions& options) {
    return Hosts::kFirstNode + Hosts::kMaxNodes + options.registries + kShares;
}

std::size_t Fleet::host_of_registry(std::size_t registry) const {
    return Hosts::kFirstNode + Hosts::kMaxNodes + registry;
}

std::size_t Fleet::host_of_share(std::size_t share) const {
    return host_of_registry(options_.registries) + share;
}

std::unique_ptr<Process> Fleet::start(std::size_t host, bool own_clock,
                                      std::vector<std::string> command) const {
    std::map<std::string, std::string> environment;
    if (own_clock && options_.clock)
        environment = {{"LD_PRELOAD", ASIP_CLOCK}, {"CLUSTER_CLOCK", folder_.file("clock")}};
    return std::make_unique<Process>(hosts_.inside(host, std::move(command)), std::move(environment));
}

// Mapped by those that have this clock, so the file stays the same one.
void Fleet::step_clock(std::chrono::seconds ahead) const {
    const std::int64_t seconds = ahead.count();
    std::fstream file(folder_.file("clock"), std::ios::in | std::ios::out | std::ios::binary);
    file.write(reinterpret_cast<const char*>(&seconds), sizeof seconds);
}

std::vector<std::string> Fleet::program(const std::string& name, std::size_t first_node,
                                        std::vector<std::string> more) const {
    std::string brokers;
    for (const auto& broker : connection(name, first_node).brokers)
        brokers += (brokers.empty() ? "" : ",") + broker.describe();
    std::vector<std::string> command{std::string(ASIP_PROGRAMS "/") + name, "--broker", brokers,
                                     "--log-level", options_.log_level};
    command.insert(command.end(), more.begin(), more.end());
    return command;
}

asip::mqtt::Options Fleet::connection(const std::string& id, std::size_t first_node) const {
    asip::mqtt::Options options;
    options.client_id = "cluster-" + id;
    options.brokers = engine_.brokers();
    const auto first = static_cast<std::ptrdiff_t>(first_node % options.brokers.size());
    std::rotate(options.brokers.begin(), options.brokers.begin() + first, options.brokers.end());
    return options;
}

asip::mqtt::Options Fleet::echo(std::size_t node) const {
    auto options = connection(fmt::format("echo-{}", node), node);
    // Twice the same one: with a list, each connection has a new identifier.
    options.brokers = {options.brokers.front(), options.brokers.front()};
    options.connect_timeout = 1s;
    options.retry_max = 200ms;
    return options;
}

void Fleet::set_up() {
    for (const auto& watcher : watchers_)
        watcher->start();
    for (const auto& echo : echoes_)
        echo->start();
    const auto steady = [&] { return catalogues_agree(0).has_value(); };
    if (!wait_for(steady)) throw std::runtime_error("the registries do not find the boards");
    depart();
    for (const auto& commander : commanders_)
        commander->start();
    const auto begin = now();
    std::vector<std::size_t> mute;
    const auto ready = [&] {
        return catalogues_agree(begin).has_value() && commands_work(begin, mute).has_value();
    };
    if (!wait_for(ready)) throw std::runtime_error("the boards cannot be commanded");
}

bool Fleet::wait_for(const std::function<bool()>& done) {
    const auto began = asip::Clock::now();
    while (!done()) {
        if (machine_.pace().passed(began, asip::Clock::now()) >= kSetUp) return false;
        asip::test::run_for(io_, std::chrono::milliseconds(kTurn));
    }
    return true;
}

void Fleet::depart() {
    for (std::size_t i = options_.boards; i < boards_.size(); ++i) {
        truth_.online.erase(history_.boards[i]);
        if (i == options_.boards)
            agents_[i]->say_goodbye();
        else
            agents_[i]->kill();
    }
}

void Fleet::run_until(Millis time) {
    while (now() < time) {
        const Millis due = std::min(time, now() + kTurn);
        asip::test::run_for(io_, std::chrono::milliseconds(due - now()));
        if (!history_.rounds.empty())
            history_.rounds.back().delayed = std::max(history_.rounds.back().delayed, now() - due);
        look_for_ends();
    }
}

Process& Fleet::process(const Fault& fault) {
    return fault.target == Target::kRegistry ? *registries_[fault.index] : *agents_[fault.index];
}

void Fleet::nodes(const Fault& fault, void (Engine::*what)(std::size_t)) {
    if (fault.target == Target::kNode) return (engine_.*what)(fault.index);
    for (std::size_t node = 0; node < engine_.nodes(); ++node)
        (engine_.*what)(node);
}

std::vector<std::size_t> Fleet::hosts_of(const Fault& fault) const {
    if (fault.target == Target::kNode) return {Hosts::kFirstNode + fault.index};
    if (fault.target == Target::kRegistry) return {host_of_registry(fault.index)};
    return {host_of_share(fault.index)};
}

void Fleet::weather(const Fault& fault, bool begins) {
    if (!begins) return network_->clear(hosts_of(fault));
    Weather weather;
    if (fault.action == Action::kSlow) {
        weather.delay = 200ms;
        weather.loss = 0.05;
    } else if (fault.action == Action::kFlap) {
        weather.flapping = 1s;
    } else {
        weather.drops_in = fault.action != Action::kCutOut;
        weather.drops_out = fault.action != Action::kCutIn;
    }
    network_->set(hosts_of(fault), weather);
}

void Fleet::begin(const Fault& fault) {
    const bool kill = fault.action == Action::kKill;
    if (is_of_network(fault.action)) return weather(fault, true);
    switch (fault.target) {
        case Target::kClock:
            return step_clock(24h);
        case Target::kAgents:
            return;
        case Target::kLink:
            return boards_[fault.index]->cut();
        case Target::kNode:
        case Target::kCluster:
            return nodes(fault, kill ? &Engine::kill : &Engine::stop);
        case Target::kAgent:
        case Target::kRegistry:
            return kill ? process(fault).kill() : process(fault).stop();
    }
}

void Fleet::end(const Fault& fault) {
    const bool kill = fault.action == Action::kKill;
    if (is_of_network(fault.action)) return weather(fault, false);
    switch (fault.target) {
        case Target::kClock:
            return step_clock(0s);
        case Target::kAgents:
            return;
        case Target::kLink:
            return boards_[fault.index]->plug();
        case Target::kNode:
        case Target::kCluster:
            return nodes(fault, kill ? &Engine::start : &Engine::go_on);
        case Target::kAgent:
        case Target::kRegistry:
            return kill ? process(fault).start() : process(fault).go_on();
    }
}

void Fleet::suffer(const std::vector<Fault>& faults) {
    history_.rounds.push_back({.name = name_of(faults), .begin = now()});
    Round& round = history_.rounds.back();
    struct Step {
        Millis at;
        bool begins;
        const Fault* fault;
    };
    std::vector<Step> steps;
    for (const auto& fault : faults) {
        const bool broker = fault.target == Target::kNode || fault.target == Target::kCluster;
        const bool held = is_of_network(fault.action) && fault.target != Target::kRegistry;
        if (held || (broker && fault.action == Action::kStop)) round.messages_held = true;
        round.nodes_apart = round.nodes_apart || (broker && engine_.nodes() > 1);
        steps.push_back({round.begin + fault.after, true, &fault});
        steps.push_back({round.begin + fault.after + fault.lasts, false, &fault});
    }
    std::stable_sort(steps.begin(), steps.end(),
                     [](const Step& one, const Step& other) { return one.at < other.at; });
    for (const auto& step : steps) {
        run_until(step.at);
        step.begins ? begin(*step.fault) : end(*step.fault);
    }
    look_for_recovery(round);
    for (const auto& watcher : watchers_)
        if (!watcher->right_since()) round.wrong[watcher->registry()] = watcher->difference();
}

// As a service manager does, but it is not forgotten.
void Fleet::look_for_ends() {
    const auto look = [&](std::vector<std::unique_ptr<Process>>& processes, const char* what) {
        for (std::size_t i = 0; i < processes.size(); ++i) {
            const auto status = processes[i]->ended_by_itself();
            if (!status) continue;
            history_.exits.push_back(fmt::format("{:.3f} s: {} {} ended by itself with status {}",
                                                 static_cast<double>(now()) / 1000, what, i, *status));
            processes[i]->start();
        }
    };
    look(agents_, "agent");
    look(registries_, "registry");
}

void Fleet::finish() {
    for (const auto& commander : commanders_)
        commander->stop();
    run_until(now() + history_.deadline + 1000);
    history_.ended = now();
}

void Fleet::write_logs(const std::string& folder) const {
    std::filesystem::create_directories(folder);
    const auto write = [&](const std::string& name, const std::string& text) {
        std::ofstream(std::filesystem::path(folder) / (name + ".log")) << text;
    };
    for (std::size_t i = 0; i < agents_.size(); ++i)
        write(history_.boards[i], agents_[i]->log());
    for (std::size_t i = 0; i < registries_.size(); ++i)
        write(watchers_[i]->registry(), registries_[i]->log());
    for (const auto& watcher : watchers_)
        write("watch-" + watcher->registry(), watcher->log());
    for (std::size_t i = 0; i < engine_.nodes(); ++i)
        write(fmt::format("{}{}", engine_.name(), i), engine_.log(i));
}

}  // namespace cluster
