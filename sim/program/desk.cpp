#include "sim/program/desk.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sim/nearest.hpp"

namespace asip::sim {
namespace {

const std::vector<std::string> kBoardVerbs = {"reset", "unplug", "replug"};
const std::vector<std::string> kPartVerbs = {"press", "release", "set", "cut", "connect"};

std::vector<std::string> all_verbs() {
    std::vector<std::string> verbs = {"list", "help", "quit"};
    verbs.insert(verbs.end(), kBoardVerbs.begin(), kBoardVerbs.end());
    verbs.insert(verbs.end(), kPartVerbs.begin(), kPartVerbs.end());
    return verbs;
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

}  // namespace

std::string_view Desk::help() {
    return "press BUTTON            press a button and hold it\n"
           "release BUTTON          let it go\n"
           "set POTENTIOMETER 0..1  turn a potentiometer\n"
           "set ULTRASONIC CM       put something in front of a distance sensor (none: it does not answer)\n"
           "set SQUARE-WAVE HERTZ   change a generator\n"
           "cut WIRE, connect WIRE  take a wire away, put it back\n"
           "reset [BOARD]           press the reset button\n"
           "unplug [BOARD]          pull the USB cable: the port disappears\n"
           "replug [BOARD]          plug it in again\n"
           "list [BOARD]            boards, their ports, their parts and what these show\n"
           "quit                    end asip-sim\n"
           "With several boards, a part is called BOARD/PART where its name alone is not clear.\n";
}

Desk::Desk(std::vector<std::unique_ptr<LiveBoard>> boards, const std::vector<BoardConfig>& configs,
           unsigned threads, std::chrono::nanoseconds slice) {
    const auto count = std::clamp<std::size_t>(threads, 1, std::max<std::size_t>(boards.size(), 1));
    std::vector<std::vector<std::unique_ptr<LiveBoard>>> shares(count);
    for (std::size_t i = 0; i < boards.size(); ++i) {
        Place place{configs[i].name, {}, i % count, shares[i % count].size()};
        for (const auto& part : configs[i].parts)
            place.parts.push_back(part.name);
        places_.push_back(std::move(place));
        shares[i % count].push_back(std::move(boards[i]));
    }
    for (auto& share : shares)
        workers_.push_back(std::make_unique<Worker>(std::move(share), slice));
}

void Desk::execute(std::string_view line, Reply reply) {
    const auto words = split(line);
    if (words.empty()) return reply(std::string());
    const auto& verb = words[0];
    if (words.size() > 3) return reply(fail(fmt::format("too many words after \"{}\"", words[2])));
    if (verb == "help") return reply(std::string(help()));
    if (verb == "list" && words.size() == 1) return list_from(0, "", std::move(reply));
    if (verb == "list" || contains(kBoardVerbs, verb)) {
        const auto place = board_called(words.size() > 1 ? words[1] : "");
        if (!place) return reply(fail(place.error()));
        return send(**place, verb, "", "", std::move(reply));
    }
    if (!contains(kPartVerbs, verb))
        return reply(fail(fmt::format("there is no command \"{}\"{}; help lists them", verb,
                                      did_you_mean(verb, all_verbs()))));
    if (words.size() < 2) return reply(fail(fmt::format("{} what? Name a part; list shows them", verb)));
    const auto part = part_called(words[1]);
    if (!part) return reply(fail(part.error()));
    send(*part->first, verb, part->second, words.size() > 2 ? words[2] : "", std::move(reply));
}

void Desk::list_from(std::size_t place, std::string so_far, Reply reply) {
    if (place == places_.size()) return reply(std::move(so_far));
    send(places_[place], "list", "", "", [=, this](const Expected<std::string>& answer) {
        list_from(place + 1, so_far + answer.value_or(""), reply);
    });
}

void Desk::send(const Place& place, std::string verb, std::string part, std::string argument, Reply reply) {
    workers_[place.worker]->post([index = place.index, verb = std::move(verb), part = std::move(part),
                                  argument = std::move(argument), reply = std::move(reply)](auto& boards) {
        reply(boards[index]->command(verb, part, argument, Clock::now()));
    });
}

Expected<const Desk::Place*> Desk::board_called(std::string_view name) const {
    if (name.empty() && places_.size() == 1) return &places_.front();
    std::vector<std::string> names;
    for (const auto& place : places_) {
        if (place.board == name) return &place;
        names.push_back(place.board);
    }
    if (name.empty()) return fail(fmt::format("which board? {}", fmt::join(names, ", ")));
    return fail(fmt::format("there is no board {}{}", name, did_you_mean(name, names)));
}

Expected<std::pair<const Desk::Place*, std::string>> Desk::part_called(std::string_view name) const {
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
    if (found.empty()) return fail(fmt::format("there is no part {}{}", part, did_you_mean(part, names)));
    if (found.size() > 1)
        return fail(
            fmt::format("{0} boards have a part {1}; say {2}/{1}", found.size(), part, found.front()->board));
    return std::pair{found.front(), std::string(part)};
}

}  // namespace asip::sim
