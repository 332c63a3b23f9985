// SPDX-License-Identifier: Apache-2.0
// How the fleet comes back behind a fault, and how long that takes.
#include <algorithm>

#include "tests/cluster/fleet.hpp"
#include "tests/cluster/judge.hpp"

namespace cluster {

namespace {

// RabbitMQ needs 10 to 20 s, on a busy machine more; all of its nodes together minutes.
constexpr auto kNodeStarts = std::chrono::minutes(3);
// A node that does not work behind all programs, which have left it.
constexpr auto kLeftNode = std::chrono::seconds(20);
constexpr Limits kLimits;
constexpr std::chrono::milliseconds kLongest(std::max(kLimits.commands, kLimits.agree));

}  // namespace

bool Fleet::had_time(const Round& round) const {
    const auto pace = machine_.pace();
    const auto end = time_of(round.end), present = asip::Clock::now();
    if (!round.engine_works) return pace.passed(end, present) >= kNodeStarts;
    return pace.had_time(time_of(*round.engine_works), kLongest, present);
}

void Fleet::look_for_recovery(Round& round) {
    round.end = now();
    for (const auto& watcher : watchers_)
        watcher->look_anew();
    for (const auto& echo : echoes_)
        echo->look_anew();
    const auto only_the_engine = [&] {
        if (!round.commands_work || !round.catalogues_agree) return false;
        const auto since = time_of(std::max(*round.commands_work, *round.catalogues_agree));
        return machine_.pace().passed(since, asip::Clock::now()) > kLeftNode;
    };
    while (!recovered(round) && !had_time(round) && !only_the_engine())
        run_until(now() + kTurn);
    round.looked_until = now();
}

bool Fleet::recovered(Round& round) {
    if (!round.commands_work) round.commands_work = commands_work(round.end, round.mute);
    round.catalogues_agree = catalogues_agree(round.end);
    round.engine_works = engine_works(round.end);
    return round.commands_work && round.catalogues_agree && round.engine_works;
}

// When the last board had answered one of the commands that were sent since.
std::optional<Millis> Fleet::commands_work(Millis end, std::vector<std::size_t>& mute) const {
    std::vector<std::optional<Millis>> first(options_.boards);
    for (auto command = history_.commands.rbegin();
         command != history_.commands.rend() && command->sent >= end; ++command) {
        if (command->outcome != Outcome::kOk) continue;
        auto& known = first[command->board];
        known = std::min(known.value_or(*command->answered), *command->answered);
    }
    mute.clear();
    Millis last = end;
    for (std::size_t board = 0; board < first.size(); ++board)
        if (first[board])
            last = std::max(last, *first[board]);
        else
            mute.push_back(board);
    return mute.empty() ? std::optional(last) : std::nullopt;
}

std::optional<Millis> Fleet::engine_works(Millis end) const {
    Millis last = end;
    for (const auto& echo : echoes_) {
        if (!echo->heard()) return std::nullopt;
        last = std::max(last, *echo->heard());
    }
    return last;
}

std::optional<Millis> Fleet::catalogues_agree(Millis end) const {
    Millis since = end;
    for (const auto& watcher : watchers_) {
        const auto right = watcher->right_since();
        if (!right) return std::nullopt;
        since = std::max(since, *right);
    }
    return now() >= since + options_.steady ? std::optional(since) : std::nullopt;
}

}  // namespace cluster
