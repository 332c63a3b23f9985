// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/judge.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cluster {
namespace {

constexpr const char* kQuiet = "between faults";

/// Applies the rules to one history.
class Judge {
  public:
    Judge(const History& history, const truth::Pace& pace, const Limits& limits)
        : history_(history), pace_(pace), limits_(limits) {}

    Verdict verdict() {
        executed_.resize(history_.commands.size());
        for (const auto& execution : history_.executions)
            if (execution.token < executed_.size())
                executed_[execution.token].push_back(execution.at);
            else
                fail(execution.at,
                     fmt::format("a board executed token {}, which nobody sent", execution.token));
        for (const auto& round : history_.rounds)
            recovery(round);
        for (std::size_t token = 0; token < history_.commands.size(); ++token)
            command(token);
        for (const auto& gap : history_.gaps)
            if (nodes_were_apart(gap))
                ++verdict_.excused_gaps;
            else
                fail(gap.at, fmt::format("watcher of {}: event {} came after {}, over one connection",
                                         gap.registry, gap.next, gap.after));
        for (const auto& exit : history_.exits)
            verdict_.violations.push_back(exit);
        return std::move(verdict_);
    }

  private:
    void fail(Millis at, const std::string& what) {
        verdict_.violations.push_back(fmt::format("{:.3f} s: {}", static_cast<double>(at) / 1000, what));
    }

    Row& row(const std::string& fault) {
        auto& rows = verdict_.rows;
        const auto found =
            std::find_if(rows.begin(), rows.end(), [&](const Row& each) { return each.fault == fault; });
        if (found != rows.end()) return *found;
        rows.push_back({.fault = fault});
        return rows.back();
    }

    static void add(std::optional<Millis>& longest, bool first, std::optional<Millis> at, Millis end) {
        if (!at || (!first && !longest))
            longest.reset();
        else
            longest = std::max(first ? 0 : *longest, *at - end);
    }

    void recovery(const Round& round) {
        Row& into = row(round.name);
        const bool first = into.rounds++ == 0;
        add(into.engine_works, first, round.engine_works, round.end);
        add(into.commands_work, first, round.commands_work, round.end);
        add(into.catalogues_agree, first, round.catalogues_agree, round.end);
        const Millis begin = round.engine_works.value_or(round.end);
        const auto in_time = [&](const std::optional<Millis>& at, Millis limit) {
            return !too_late(begin, limit, at.value_or(round.looked_until), at.has_value());
        };
        if (!in_time(round.commands_work, limits_.commands))
            fail(round.end, fmt::format("{}: commands did not work again within {} ms:{}", round.name,
                                        limits_.commands, names_of_mute(round, history_)));
        if (in_time(round.catalogues_agree, limits_.agree)) return;
        std::string how;
        for (const auto& [registry, difference] : round.wrong) {
            how += fmt::format(" {}:", registry);
            how += difference.none() ? " no answer" : text_of(difference);
        }
        fail(round.end, fmt::format("{}: catalogues did not agree with the truth within {} ms:{}", round.name,
                                    limits_.agree, how));
    }

    /// Whether `at`, when it came or was given up, is too late: on a starved machine where the programs had
    /// the time for it.
    bool too_late(Millis since, Millis limit, Millis at, bool came) {
        if (came && at <= since + limit) return false;
        const auto from = time_of(since), to = time_of(at);
        if (!pace_.starved(from, to) || pace_.had_time(from, std::chrono::milliseconds(limit), to))
            return true;
        ++verdict_.starved;
        return false;
    }

    /// Whether more than `slack` passed for the programs.
    bool longer(Millis from, Millis to, Millis slack) {
        if (to <= from + slack) return false;
        if (pace_.passed(time_of(from), time_of(to)) > std::chrono::milliseconds(slack)) return true;
        ++verdict_.starved;
        return false;
    }

    /// Until when a fault may be the reason for what happens to commands.
    static Millis recovered(const Round& round) {
        if (!round.commands_work || !round.catalogues_agree) return round.looked_until;
        return std::max(*round.commands_work, *round.catalogues_agree);
    }

    const Round* round_at(Millis time) const {
        for (const auto& round : history_.rounds)
            if (time >= round.begin && time <= recovered(round)) return &round;
        return nullptr;
    }

    /// No fault between sending and the end of the deadline.
    bool undisturbed(const Command& command) const {
        const Millis until = command.sent + history_.deadline + limits_.slack;
        if (until > history_.ended) return false;
        return std::none_of(history_.rounds.begin(), history_.rounds.end(), [&](const Round& round) {
            return command.sent <= recovered(round) && round.begin <= until;
        });
    }

    bool held(const Command& command, Millis until) const {
        return std::any_of(history_.rounds.begin(), history_.rounds.end(), [&](const Round& round) {
            return round.messages_held && command.sent <= recovered(round) && round.begin <= until;
        });
    }

    bool nodes_were_apart(const Gap& gap) const {
        return std::any_of(history_.rounds.begin(), history_.rounds.end(), [&](const Round& round) {
            return round.nodes_apart && round.begin <= gap.at && gap.since <= recovered(round);
        });
    }

    void command(std::size_t token) {
        const Command& command = history_.commands[token];
        const auto& executed = executed_[token];
        const Round* const round = round_at(command.sent);
        Row& into = row(round != nullptr ? round->name : kQuiet);
        ++into.answers[static_cast<std::size_t>(command.outcome)];
        const auto wrong = [&](const std::string& what) {
            fail(command.sent,
                 fmt::format("{}: command {} to {} ({}{}{}) {}", round ? round->name : kQuiet, token,
                             history_.boards.at(command.board), to_string(command.outcome),
                             command.reason.empty() ? "" : ": ", command.reason, what));
        };
        if (command.outcome == Outcome::kOk && executed.empty()) wrong("was not executed");
        if (executed.size() > 1) wrong(fmt::format("was executed {} times", executed.size()));
        if (command.outcome == Outcome::kRefused && !executed.empty()) wrong("was executed");
        if (command.outcome == Outcome::kError) wrong("is one that the board knows");
        if (command.differing) wrong("was answered again, and otherwise");
        if (command.outcome == Outcome::kUnanswered && undisturbed(command) &&
            too_late(command.sent, 0, command.sent + history_.deadline + limits_.slack, false))
            wrong("has no answer, and nothing was disturbed");
        if (executed.empty()) return;
        const Millis last = executed.back();
        if (!longer(command.sent + history_.deadline, last, limits_.slack)) {
            if (command.answered && longer(*command.answered, last, limits_.order))
                wrong(fmt::format("was executed {} ms after its answer", last - *command.answered));
            return;
        }
        if (held(command, last))
            ++into.late_and_held;
        else
            wrong(fmt::format("was executed {} ms after it was sent", last - command.sent));
    }

    const History& history_;
    const truth::Pace& pace_;
    Limits limits_;
    std::vector<std::vector<Millis>> executed_;
    Verdict verdict_;
};

std::string seconds(const std::optional<Millis>& time) {
    return time ? fmt::format("{:.2f} s", static_cast<double>(*time) / 1000) : "never";
}

}  // namespace

asip::Time time_of(Millis time) {
    static const auto began = asip::Clock::now();
    return began + std::chrono::milliseconds(time);
}

const char* to_string(Outcome outcome) {
    switch (outcome) {
        case Outcome::kOk:
            return "ok";
        case Outcome::kError:
            return "error";
        case Outcome::kTimeout:
            return "timeout";
        case Outcome::kRefused:
            return "refused";
        case Outcome::kUnanswered:
            break;
    }
    return "unanswered";
}

std::string text_of(const Difference& difference) {
    std::string text;
    for (const auto& board : difference.ghosts)
        text += ' ' + board + " is a ghost";
    for (const auto& board : difference.lost)
        text += ' ' + board + " lives and is not online";
    return text;
}

std::string names_of_mute(const Round& round, const History& history) {
    std::string names;
    for (const auto board : round.mute)
        names += ' ' + history.boards.at(board);
    return names;
}

Verdict judge(const History& history, const truth::Pace& pace, const Limits& limits) {
    return Judge(history, pace, limits).verdict();
}

std::string report(const std::string& engine, const Verdict& verdict) {
    std::string text = fmt::format("{:<11}{:<34}{:>6}{:>10}{:>10}{:>11}{:>8}{:>7}{:>8}{:>8}{:>7}{:>6}\n",
                                   "engine", "fault", "rounds", "broker", "commands", "catalogues", "ok",
                                   "error", "timeout", "refused", "none", "late");
    for (const auto& row : verdict.rows) {
        const bool fault = row.rounds > 0;
        text += fmt::format("{:<11}{:<34}{:>6}{:>10}{:>10}{:>11}{:>8}{:>7}{:>8}{:>8}{:>7}{:>6}\n", engine,
                            row.fault, fault ? std::to_string(row.rounds) : "",
                            fault ? seconds(row.engine_works) : "", fault ? seconds(row.commands_work) : "",
                            fault ? seconds(row.catalogues_agree) : "", row.answers[0], row.answers[1],
                            row.answers[2], row.answers[3], row.answers[4], row.late_and_held);
    }
    if (verdict.excused_gaps > 0)
        text +=
            fmt::format("{} times events were lost between nodes that were apart, as their numbers told\n",
                        verdict.excused_gaps);
    if (verdict.starved > 0)
        text += fmt::format("{} times something was late on a starved machine\n", verdict.starved);
    for (const auto& violation : verdict.violations)
        text += "VIOLATION " + violation + '\n';
    return text;
}

}  // namespace cluster
