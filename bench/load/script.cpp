// SPDX-License-Identifier: Apache-2.0
#include "bench/load/script.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <utility>

#include "asip/text/duration.hpp"
#include "asip/text/file_text.hpp"
#include "asip/text/nearest.hpp"

namespace asip::load {
namespace {

constexpr std::array<std::pair<Verb, std::string_view>, 5> kVerbs{{{Verb::kJoin, "join"},
                                                                   {Verb::kDie, "die"},
                                                                   {Verb::kFlap, "flap"},
                                                                   {Verb::kHang, "hang"},
                                                                   {Verb::kLeave, "leave"}}};
constexpr std::size_t kMaxSteps = 10'000;
constexpr Duration kShortestRound = std::chrono::milliseconds(10);
// A moment that next() named is not missed by a rounding.
constexpr double kRounding = 1e-6;
// How soon boards are looked at again on which a step waits.
constexpr Duration kSettledTick = std::chrono::milliseconds(20);
constexpr const char* kForm =
    "AT VERB BOARDS [over TIME] [down TIME] [every TIME], such as \"30s flap 1% every 10s\" or \"then die "
    "5\"";

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    std::string word;
    for (const char c : text)
        if (c != ' ' && c != '\t' && c != '\r')
            word += c;
        else if (!word.empty())
            words.push_back(std::exchange(word, {}));
    if (!word.empty()) words.push_back(std::move(word));
    return words;
}

Expected<Verb> parse_verb(const std::string& word) {
    std::vector<std::string> known;
    for (const auto& [verb, name] : kVerbs) {
        if (name == word) return verb;
        known.emplace_back(name);
    }
    return fail("\"" + word + "\" is none of join, die, flap, hang, leave" + text::did_you_mean(word, known));
}

Expected<Amount> parse_amount(const std::string& word) {
    if (word == "all") return Amount{0, 1};
    Amount amount;
    const char* const end = word.data() + word.size();
    if (word.ends_with('%')) {
        double percent = 0;
        const auto read = std::from_chars(word.data(), end - 1, percent);
        if (read.ec == std::errc() && read.ptr == end - 1 && percent > 0 && percent <= 100) {
            amount.part = percent / 100;
            return amount;
        }
    } else {
        const auto read = std::from_chars(word.data(), end, amount.number);
        if (read.ec == std::errc() && read.ptr == end && amount.number > 0) return amount;
    }
    return fail("\"" + word + "\" is no number of boards: 100, 5% or all");
}

Expected<void> parse_at(Step& step, std::string_view word) {
    constexpr std::string_view kThen = "then";
    step.then = word == kThen || word.starts_with("then+");
    if (word == kThen) return {};
    const auto time = text::parse_duration(word.substr(step.then ? kThen.size() + 1 : 0));
    if (!time) return fail(time.error() + "; a step is " + kForm);
    step.at = *time;
    return {};
}

Expected<void> parse_part(Step& step, const std::string& name, const std::string& value) {
    Duration* const member = name == "over"    ? &step.over
                             : name == "down"  ? &step.down
                             : name == "every" ? &step.every
                                               : nullptr;
    if (member == nullptr)
        return fail("\"" + name + "\" is none of over, down, every" +
                    text::did_you_mean(name, std::array<std::string, 3>{"over", "down", "every"}));
    const auto time = text::parse_duration(value);
    if (!time) return fail(name + ": " + time.error());
    *member = *time;
    return {};
}

}  // namespace

std::string_view name_of(Verb verb) {
    for (const auto& [known, name] : kVerbs)
        if (known == verb) return name;
    return "";
}

std::size_t Amount::of(std::size_t boards) const {
    if (part == 0) return std::min(number, boards);
    return static_cast<std::size_t>(std::llround(std::ceil(part * static_cast<double>(boards) - 1e-9)));
}

Expected<Step> parse_step(std::string_view text) {
    const auto words = words_of(text);
    if (words.size() < 3 || words.size() % 2 == 0)
        return fail("\"" + std::string(text) + "\" is not a step: " + kForm);
    Step step;
    if (const auto at = parse_at(step, words[0]); !at) return fail(at.error());
    const auto verb = parse_verb(words[1]);
    if (!verb) return fail(verb.error());
    step.verb = *verb;
    const auto amount = parse_amount(words[2]);
    if (!amount) return fail(amount.error());
    step.amount = *amount;
    std::vector<std::string> parts;
    for (std::size_t i = 3; i < words.size(); i += 2) {
        if (std::find(parts.begin(), parts.end(), words[i]) != parts.end())
            return fail(words[i] + ": given twice");
        parts.push_back(words[i]);
        if (const auto part = parse_part(step, words[i], words[i + 1]); !part) return fail(part.error());
        if (words[i] == "down" && step.verb != Verb::kFlap)
            return fail(
                "down: only boards that flap come back; a board that is to come back later joins again");
    }
    if (step.every != Duration{} && (step.every < step.over || step.every < kShortestRound))
        return fail("every: shorter than " + std::string(step.every < step.over ? "over" : "10ms"));
    return step;
}

Expected<std::vector<Step>> read_script(const std::string& path) {
    std::ifstream file(path);
    if (!file) return fail("cannot read " + path);
    std::vector<Step> steps;
    std::string line;
    for (std::size_t number = 1; std::getline(file, line); ++number) {
        if (number == 1) line = std::string(text::without_mark(line));
        line = line.substr(0, line.find('#'));
        if (words_of(line).empty()) continue;
        auto step = parse_step(line);
        if (!step) return fail(path + ":" + std::to_string(number) + ": " + step.error());
        if (steps.size() == kMaxSteps)
            return fail(path + ": more than " + std::to_string(kMaxSteps) + " steps");
        steps.push_back(*step);
    }
    if (steps.empty()) return fail(path + " has no steps; a step is " + kForm);
    return steps;
}

Plan::Plan(std::vector<Step> steps, std::size_t boards) {
    for (auto& step : steps)
        steps_.push_back({.step = step,
                          .total = step.amount.of(boards),
                          .from = step.then ? std::nullopt : std::optional(Duration{})});
}

std::vector<Plan::Due> Plan::due(Duration now, bool settled) {
    std::vector<Due> result;
    for (auto& running : steps_) {
        auto& [step, total, round, done, from] = running;
        // What is due in this moment unsettles the boards.
        if (!from && settled && result.empty()) from = now;
        if (!from) {
            settled = false;
            continue;
        }
        std::size_t count = 0;
        for (;;) {
            const Duration begins = running.begins();
            if (now < begins) break;
            const double part = step.over == Duration{}
                                    ? 1.0
                                    : std::min(1.0, std::chrono::duration<double>(now - begins) /
                                                        std::chrono::duration<double>(step.over));
            const auto reached = static_cast<std::size_t>(part * static_cast<double>(total) + kRounding);
            count += reached - std::min(reached, done);
            done = std::max(done, reached);
            if (done < total || step.every == Duration{}) break;
            ++round;
            done = 0;
        }
        if (count > 0) result.push_back({step.verb, count, step.down});
        settled = settled && running.once_done();
    }
    return result;
}

std::optional<Duration> Plan::next(Duration now) const {
    std::optional<Duration> soonest;
    for (const auto& running : steps_) {
        const auto& [step, total, round, done, from] = running;
        if (done >= total) continue;
        if (!from) {
            if (!soonest || now + kSettledTick < *soonest) soonest = now + kSettledTick;
            continue;
        }
        Duration when = running.begins();
        if (when <= now || done > 0) {
            const Duration one = step.over / static_cast<Duration::rep>(std::max<std::size_t>(total, 1));
            when += std::max<Duration>(one * static_cast<Duration::rep>(done + 1), Duration{});
        }
        if (!soonest || when < *soonest) soonest = when;
    }
    return soonest;
}

}  // namespace asip::load
