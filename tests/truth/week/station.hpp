// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "agent/links/link_files.hpp"
#include "tests/truth/presence/sim_broker.hpp"
#include "tests/unit/agent/bridge_bench.hpp"

namespace truth::week {

using asip::Duration;
using asip::Time;
using presence::Message;
using presence::SimBroker;

/// When each station has to be called next.
class Deadlines {
  public:
    void set(std::size_t number, Time due) {
        due_.resize(std::max(due_.size(), number + 1), Time::max());
        if (due == due_[number]) return;
        queue_.erase({due_[number], number});
        due_[number] = due;
        if (due != Time::max()) queue_.insert({due, number});
    }
    Time next() const { return queue_.empty() ? Time::max() : queue_.begin()->first; }
    /// Those that are due, the earliest first.
    const std::vector<std::size_t>& until(Time now) {
        found_.clear();
        for (auto at = queue_.begin(); at != queue_.end() && at->first <= now; ++at)
            found_.push_back(at->second);
        return found_;
    }

  private:
    std::vector<Time> due_;
    std::set<std::pair<Time, std::size_t>> queue_;
    std::vector<std::size_t> found_;
};

/// A model board with the core of its agent, on the broker.
class Station {
  public:
    /// What its machine has: the time of day, the way to the broker, and a disk for links.
    struct Machine {
        int lease_seconds;
        std::function<std::uint64_t()> unix_time;
        std::function<int()> second_of_day;
        std::function<bool()> hears_broker;
        asip::agent::LinkFiles links;
        std::function<void(Time)> call_at;               ///< tick() has to be called then
        std::function<void(const std::string&)> failed;  ///< something went wrong
    };
    Station(SimBroker& broker, std::string name, Machine machine)
        : broker_(broker), name_(std::move(name)), machine_(std::move(machine)) {}

    const std::string& name() const { return name_; }
    bool runs() const { return bench_ != nullptr; }
    /// The state that every view has to show.
    std::string state() const {
        if (!bench_) return stopped_ ? "offline" : "lost";
        return client_ != 0 && plugged_ ? "online" : "lost";
    }
    /// The angle of its servo; none: nothing has set it since the board or its agent started.
    std::optional<int> servo() const { return servo_; }
    std::optional<int> distance() const { return distance_; }

    // --- the agent: a new process each time
    void start(Time now) {
        auto options = asip::agent::BridgeBench::defaults();
        options.name = name_;
        options.lease_seconds = machine_.lease_seconds;
        options.started_unix = machine_.unix_time();
        options.second_of_day = machine_.second_of_day;
        options.load_links = [this](const std::string& board) { return machine_.links.load(board); };
        begin_anew();  // it knows nothing of what was before
        bench_ = std::make_unique<asip::agent::BridgeBench>(std::move(options));
        bench_->now = now;
        bench_->board = std::move(board_);
        bench_->board.verified_fences = true;
        bench_->board.stored_name = name_;
        connects_ = now;
        if (plugged_) bench_->plug();
        perform(now);
    }
    void stop(Time now) {
        run(now, [&](Effects& out) { bench_->bridge.leave_line(now, out); });
        run(now, [&](Effects& out) { bench_->bridge.goodbye(now, out); });
        end(true, now);
    }
    void kill(Time now) { end(false, now); }
    /// The connection ends; `will`: the broker says that the board is lost.
    void lose_broker(bool will, Time now) {
        if (bench_) broker_.end(lose_network(now), will, now);
    }
    /// The same, where the broker does not know it yet; returns what it takes for a client.
    SimBroker::Client lose_network(Time now) {
        if (client_ != 0) bench_->bridge.bus_disconnected();
        bench_->bridge.sources_heard(false, now);
        broker_.end(std::exchange(sources_, 0), false, now);
        subscribed_ = false;
        connects_ = now + std::chrono::seconds(1);
        call_in_time();
        return std::exchange(client_, 0);
    }
    void link(const nlohmann::json& set, Time now) {
        reach(now);
        bench_->ask("asip/" + name_ + "/$link/ann/c", {{"set", set}});
        perform(now);
    }

    // --- the board
    void plug(Time now) {
        plugged_ = true;
        reach(now);
        bench_->board.reboot();
        bench_->plug();
        perform(now);
    }
    void unplug(Time now) {
        plugged_ = false;
        begin_anew();
        reach(now);
        bench_->unplug();
        perform(now);
    }
    void restart(Time now) {
        begin_anew();
        say(bench_->board.reboot(), now);
    }
    void measure(int centimetres, Time now) {
        distance_ = centimetres;
        say(bench_->board.framed("@D,e,1,{" + std::to_string(centimetres) + "}"), now);
    }

    void tick(Time now) {
        reach(now);
        if (connects_ && *connects_ <= now) {
            connects_.reset();
            if (machine_.hears_broker() && !bench_->bridge.name().empty())
                connect(now);
            else
                connects_ = now + std::chrono::seconds(1);
        }
        perform(now);
    }

  private:
    using Effects = asip::agent::Effects;

    void begin_anew() {
        servo_.reset();
        distance_.reset();
    }
    void say(const std::string& bytes, Time now) {
        reach(now);
        bench_->say(bytes);
        perform(now);
    }
    void end(bool stopped, Time now) {
        stopped_ = stopped;
        lose_broker(!stopped, now);
        board_ = std::move(bench_->board);
        bench_.reset();
        machine_.call_at(Time::max());
    }
    /// Time passes up to `now`.
    void reach(Time now) {
        if (now > bench_->now) bench_->pass(now - bench_->now);
    }
    template <class Call>
    void run(Time now, Call&& call) {
        if (!bench_) return;
        reach(now);
        bench_->run(std::forward<Call>(call));
        perform(now);
    }
    void connect(Time now) {
        client_ = broker_.connect(
            [this](const Message& message, Time at) {
                if (!bench_ || client_ == 0) return;
                reach(at);
                bench_->hear(message);
                perform(at);
            },
            bench_->bridge.will());
        sources_ = broker_.connect([this](const Message& message, Time at) {
            run(at, [&](Effects& out) { bench_->bridge.source_message(message, bench_->now, out); });
        });
        source_changes_ = 0;
        for (const auto& one : bench_->bridge.subscriptions())
            broker_.subscribe(client_, one.filter, one.options.no_local, one.options.retained, now);
        bench_->connect();
    }
    void subscribe(Time now) {
        const auto& bridge = bench_->bridge;
        if (client_ != 0 && bridge.name_claimed() && !std::exchange(subscribed_, true))
            for (const auto& one : bridge.control_subscriptions())
                broker_.subscribe(client_, one.filter, one.options.no_local, one.options.retained, now);
        if (std::exchange(source_changes_, bridge.source_changes()) != bridge.source_changes())
            for (const auto& filter : bridge.source_subscriptions())
                broker_.subscribe(sources_, filter, false, true, now);
    }
    /// What the agent wants done, as its shell does it.
    void perform(Time now) {
        for (auto& link : std::exchange(bench_->links_to_keep, {})) {
            const auto kept = machine_.links.save(name_, link.name, link.text);
            bench_->run([&](Effects& out) { bench_->bridge.link_kept(link.ticket, kept, bench_->now, out); });
        }
        for (auto& [message, priority] : std::exchange(bench_->published, {}))
            if (client_ != 0) broker_.publish(client_, std::move(message), now);
        subscribe(now);
        for (const auto& line : std::exchange(bench_->board.executed, {})) {
            int servo = 0, angle = 0;
            if (std::sscanf(line.c_str(), "S,W,%d,%d", &servo, &angle) == 2) servo_ = angle;
            if (line == "#,R") servo_.reset();
        }
        bench_->board.heard.clear();
        bench_->notices.clear();
        bench_->client_lines.clear();
        if (bench_->fatal) machine_.failed(name_ + ": " + bench_->fatal->text);
        call_in_time();
    }
    void call_in_time() {
        const auto due = bench_->bridge.next_deadline().value_or(Time::max());
        machine_.call_at(std::min(due, connects_.value_or(Time::max())));
    }

    SimBroker& broker_;
    const std::string name_;
    Machine machine_;
    std::unique_ptr<asip::agent::BridgeBench> bench_;
    asip::session::ScriptedBoard board_;  // while no agent runs
    SimBroker::Client client_ = 0, sources_ = 0;
    std::uint64_t source_changes_ = 0;
    bool subscribed_ = false, plugged_ = true, stopped_ = false;
    std::optional<Time> connects_;
    std::optional<int> servo_, distance_;
};

}  // namespace truth::week
