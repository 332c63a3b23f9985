// SPDX-License-Identifier: Apache-2.0
#include "sim/program/running_boards.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "asip/text/nearest.hpp"

namespace asip::sim {
namespace {

constexpr std::array kBoardCommands{
    PartVerb{"reset", "[BOARD]", "press the reset button"},
    PartVerb{"unplug", "[BOARD]", "pull the USB cable: the port disappears"},
    PartVerb{"replug", "[BOARD]", "plug it in again"},
    PartVerb{"load", "BOARD IMAGE", "exchange the firmware (.elf or .hex), as a programmer does"},
    PartVerb{"list", "[BOARD]", "boards, their ports, their parts and what these show"},
};

std::set<std::string, std::less<>> part_verbs() {
    std::set<std::string, std::less<>> verbs;
    for (const auto* kind : PartKind::all())
        for (const auto& verb : kind->verbs)
            verbs.emplace(verb.name);
    return verbs;
}

bool is_board_command(std::string_view word) {
    return std::any_of(kBoardCommands.begin(), kBoardCommands.end(),
                       [&](const PartVerb& command) { return command.name == word; });
}

std::vector<std::string> all_commands() {
    std::vector<std::string> words = {"help", "quit"};
    for (const auto& command : kBoardCommands)
        words.emplace_back(command.name);
    for (const auto& verb : part_verbs())
        words.push_back(verb);
    return words;
}

std::string upper(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return result;
}

std::string help_line(std::string_view usage, std::string_view help) {
    return fmt::format("{:<23} {}\n", usage, help);
}

bool contains(const std::vector<std::string>& words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

std::vector<std::string> split(std::string_view line) {
    std::vector<std::string> words;
    std::size_t start = 0;
    while ((start = line.find_first_not_of(" \t\r\n", start)) != std::string_view::npos) {
        const auto end = std::min(line.find_first_of(" \t\r\n", start), line.size());
        words.emplace_back(line.substr(start, end - start));
        start = end;
    }
    return words;
}

/// The line from that word on, with its blanks: the name of a file.
std::string rest_from(std::string_view line, std::size_t word) {
    constexpr std::string_view kBlanks = " \t\r\n";
    for (std::size_t i = 0;; ++i) {
        line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
        if (i == word) return std::string(line.substr(0, line.find_last_not_of(kBlanks) + 1));
        line.remove_prefix(std::min(line.find_first_of(kBlanks), line.size()));
    }
}

/// How many words a command takes behind the part, at most.
std::size_t words_after_part(std::string_view verb) {
    std::size_t most = 1;
    for (const auto* kind : PartKind::all())
        if (const auto* found = kind->verb(verb)) most = std::max(most, split(found->argument).size());
    return most;
}

}  // namespace

std::string RunningBoards::help() {
    std::string text;
    for (const auto* kind : PartKind::all())
        for (const auto& verb : kind->verbs)
            text +=
                help_line(fmt::format("{} {} {}", verb.name, upper(kind->name), verb.argument), verb.help);
    for (const auto& command : kBoardCommands)
        text += help_line(fmt::format("{} {}", command.name, command.argument), command.help);
    return text + help_line("quit", "end asip-sim") +
           "With several boards, a part is called BOARD/PART where its name alone is not clear.\n";
}

RunningBoards::RunningBoards(std::vector<std::unique_ptr<LiveBoard>> boards, unsigned threads,
                             std::chrono::nanoseconds slice) {
    const auto count = std::clamp<std::size_t>(threads, 1, std::max<std::size_t>(boards.size(), 1));
    std::vector<std::vector<std::unique_ptr<LiveBoard>>> shares(count);
    for (std::size_t i = 0; i < boards.size(); ++i) {
        auto& share = shares[i % count];
        places_.push_back({boards[i]->name(), boards[i]->part_names(), i % count, share.size()});
        share.push_back(std::move(boards[i]));
    }
    for (auto& share : shares)
        workers_.push_back(std::make_unique<Worker>(std::move(share), slice));
}

void RunningBoards::execute(std::string_view line, Reply reply) {
    const auto words = split(line);
    if (words.empty()) return reply(std::string());
    const auto& verb = words[0];
    if (verb != "load" && words.size() > 2 + words_after_part(verb))
        return reply(fail(fmt::format("too many words after \"{}\"", words[1 + words_after_part(verb)])));
    if (verb == "help") return reply(help());
    if (verb == "list" && words.size() == 1) return list_from(0, "", std::move(reply));
    if (is_board_command(verb)) {
        const auto place = board_called(words.size() > 1 ? words[1] : "");
        if (!place) return reply(fail(place.error()));
        const auto argument = words.size() > 2 ? rest_from(line, 2) : std::string();
        if (argument.empty() != (verb != "load"))
            return reply(fail(verb == "load" ? std::string("load what? load BOARD IMAGE")
                                             : fmt::format("too many words after \"{}\"", words[1])));
        return send(**place, verb, "", argument, std::move(reply));
    }
    if (!part_verbs().contains(verb))
        return reply(fail(fmt::format("there is no command \"{}\"{}; help lists them", verb,
                                      text::did_you_mean(verb, all_commands()))));
    if (words.size() < 2) return reply(fail(fmt::format("{} what? Name a part; list shows them", verb)));
    const auto part = part_called(words[1]);
    if (!part) return reply(fail(part.error()));
    const std::vector<std::string> argument(words.begin() + 2, words.end());
    send(*part->first, verb, part->second, fmt::format("{}", fmt::join(argument, " ")), std::move(reply));
}

void RunningBoards::list_from(std::size_t place, std::string so_far, Reply reply) {
    if (place == places_.size()) return reply(std::move(so_far));
    send(places_[place], "list", "", "", [=, this](const Expected<std::string>& answer) {
        list_from(place + 1, so_far + answer.value_or(""), reply);
    });
}

void RunningBoards::send(const Place& place, std::string verb, std::string part, std::string argument,
                         Reply reply) {
    workers_[place.worker]->post([index = place.index, verb = std::move(verb), part = std::move(part),
                                  argument = std::move(argument), reply = std::move(reply)](auto& boards) {
        reply(boards[index]->command(verb, part, argument, Clock::now()));
    });
}

Expected<const RunningBoards::Place*> RunningBoards::board_called(std::string_view name) const {
    if (name.empty() && places_.size() == 1) return &places_.front();
    std::vector<std::string> names;
    for (const auto& place : places_) {
        if (place.board == name) return &place;
        names.push_back(place.board);
    }
    if (name.empty()) return fail(fmt::format("which board? {}", fmt::join(names, ", ")));
    return fail(fmt::format("there is no board {}{}", name, text::did_you_mean(name, names)));
}

Expected<std::pair<const RunningBoards::Place*, std::string>> RunningBoards::part_called(
    std::string_view name) const {
    const auto slash = name.find('/');
    const auto part = slash == std::string_view::npos ? name : name.substr(slash + 1);
    std::vector<const Place*> found;
    std::vector<std::string> names;
    if (slash != std::string_view::npos)
        if (auto board = board_called(name.substr(0, slash)); !board) return fail(board.error());
    for (const auto& place : places_) {
        if (slash != std::string_view::npos && place.board != name.substr(0, slash)) continue;
        if (contains(place.parts, part)) found.push_back(&place);
        names.insert(names.end(), place.parts.begin(), place.parts.end());
    }
    if (found.empty())
        return fail(fmt::format("there is no part {}{}", part, text::did_you_mean(part, names)));
    if (found.size() > 1)
        return fail(fmt::format("{0} boards have a part {1}; name it {2}/{1}", found.size(), part,
                                found.front()->board));
    return std::pair{found.front(), std::string(part)};
}

}  // namespace asip::sim
