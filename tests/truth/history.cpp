// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/history.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tests/truth/world.hpp"

namespace truth {

namespace {

class History : World {
  public:
    History(std::uint64_t seed, bool trace) : World(drawn(seed, trace)), commands_(dice_) {}

    HistoryEnd run();

  private:
    static Setting drawn(std::uint64_t seed, bool trace);
    void clients();

    CommandSource commands_;
    std::vector<Micros> client_next_;
};

World::Setting History::drawn(std::uint64_t seed, bool trace) {
    Dice dice(seed);
    Plan plan = draw_plan(seed, dice);
    const bool calm = plan.calm();
    return {std::move(dice), std::move(plan), calm, trace};
}

void History::clients() {
    for (std::size_t i = 0; i < client_next_.size(); ++i) {
        if (client_next_[i] > now_) continue;
        const ClientPlan& client = plan_.clients[i];
        const auto count = dice_.chance(client.burst) ? dice_.between(2, 12) : 1;
        for (auto k = count; k > 0; --k)
            agent_.submit(commands_.draw(static_cast<unsigned>(i + 1), client), now_);
        const Micros next = now_ + dice_.between(1, 2 * client.pause);
        client_next_[i] = next < plan_.active ? next : kNever;
    }
}

HistoryEnd History::run() {
    std::sort(plan_.incidents.begin(), plan_.incidents.end(),
              [](const Incident& a, const Incident& b) { return a.at < b.at; });
    incidents_ = plan_.incidents;
    if (trace_) lines_.push_back(describe(plan_));
    ledger_.counts.histories = 1;
    for (const ClientPlan& client : plan_.clients)
        client_next_.push_back(dice_.between(0, 2 * client.pause));
    const bool boots = dice_.chance(0.5);
    board_.restart(0, boots ? plan_.boot : 0);
    if (!boots) board_.run(0);
    agent_.link_up(boots, 0);
    while (!ledger_.failed()) {
        now_ = next(*std::min_element(client_next_.begin(), client_next_.end()));
        if (now_ > plan_.active && (ledger_.open() == 0 || now_ > ledger_.last_deadline() + 2 * kMillisecond))
            break;
        pass();
        clients();
    }
    ledger_.finish();
    return {ledger_.counts, ledger_.failure(), std::move(lines_)};
}

}  // namespace

HistoryEnd run_history(std::uint64_t seed, bool trace) {
    return History(seed, trace).run();
}

}  // namespace truth
