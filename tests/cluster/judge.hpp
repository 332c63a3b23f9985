// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tests/cluster/history.hpp"
#include "tests/truth/presence/machine.hpp"

namespace cluster {

/// What is demanded of the time after a fault, counted from when the engine itself works again, and what the
/// judge allows its own measuring. On a machine that starves its programs it is a time that they had.
struct Limits {
    Millis agree = 10'000;     ///< until all catalogues are right
    Millis commands = 10'000;  ///< until each board can be commanded
    Millis slack = 1000;       ///< of deadlines: client and agent begin to count at other moments
    Millis order = 500;        ///< of an execution and its answer, which come on two ways
};

/// One line of the table: a fault by name, all its rounds together.
struct Row {
    std::string fault;
    std::size_t rounds = 0;
    std::optional<Millis> engine_works{};      ///< the longest, from its end; none: not in one of them
    std::optional<Millis> commands_work{};     ///< the same
    std::optional<Millis> catalogues_agree{};  ///< the same
    std::array<std::size_t, 5> answers{};      ///< by Outcome: commands sent from its begin to its recovery
    std::size_t late_and_held = 0;  ///< executed after the deadline, because it was held on its way
};

struct Verdict {
    std::vector<Row> rows;  ///< in the order in which the faults came first; then "between faults"
    std::vector<std::string> violations;
    std::size_t excused_gaps = 0;  ///< in the events of a registry, while nodes of the engine were apart
    std::size_t starved = 0;       ///< times that were too long only since the machine was too busy
};

/// Decides, by what the boards executed and the registries said, whether all was as promised. Pure.
/// `pace`: of the machine, by time_of() the times of the history.
Verdict judge(const History& history, const truth::Pace& pace, const Limits& limits = {});

/// What is wrong, each behind a blank.
std::string text_of(const Difference& difference);

/// The boards that executed nothing after the round, each behind a blank.
std::string names_of_mute(const Round& round, const History& history);

/// The table and the violations as text.
std::string report(const std::string& engine, const Verdict& verdict);

}  // namespace cluster
