// SPDX-License-Identifier: Apache-2.0
#include "cli/find/target.hpp"

#include <algorithm>

#include "asip/bus/pattern.hpp"
#include "asip/model/names.hpp"
#include "asip/text/nearest.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

std::string without_wildcards(std::string_view text) {
    std::string result;
    std::copy_if(text.begin(), text.end(), std::back_inserter(result),
                 [](char c) { return c != '*' && c != '?'; });
    return result;
}

bool is_glob(std::string_view text) {
    return text.find_first_of("*?") != std::string_view::npos;
}

}  // namespace

bool Target::is_pattern() const {
    return is_glob(board) || is_glob(service);
}

bool Target::matches(std::string_view board_name, std::string_view service_name) const {
    return bus::matches_pattern(board, board_name) && bus::matches_pattern(service, service_name);
}

Outcome<Target> parse_target(std::string_view text, bool patterns) {
    const auto slash = text.find('/');
    Target target{std::string(text.substr(0, slash)), {}};
    if (slash != std::string_view::npos) target.service = text.substr(slash + 1);
    if (target.is_pattern() && !patterns)
        return failure(program::kExitUsage, "'" + std::string(text) + "': no wildcards here; name one board");
    const auto board = without_wildcards(target.board);
    const bool board_ok =
        board.empty() ? is_glob(target.board) : model::valid_board_name(board) || is_glob(target.board);
    if (!board_ok) {
        return failure(program::kExitUsage, target.board.empty() ? "name a board: BOARD or BOARD/SERVICE"
                                                                 : model::explain_board_name(target.board));
    }
    const auto service = without_wildcards(target.service);
    if (slash != std::string_view::npos &&
        !(model::valid_name(service) || (service.empty() && is_glob(target.service)))) {
        return failure(program::kExitUsage,
                       "'" + std::string(text) + "' is not BOARD/SERVICE; names are of A-Z a-z 0-9 . _ -");
    }
    return target;
}

Outcome<void> check_board_pattern(std::string_view text, std::string_view verb) {
    const auto target = parse_target(text, true);
    if (!target) return tl::unexpected(target.error());
    if (target->service.empty()) return {};
    return failure(program::kExitUsage, std::string(verb) + " takes a board, not a service");
}

void declare_selector(Declaration& verb, SelectorText& text) {
    verb.option("-l,--selector", "SELECTOR", text,
                "Only boards with these labels: room=lab,floor!=2,camera,!old; all must hold");
}

Outcome<bus::LabelSelector> parse_selector(const SelectorText& text) {
    if (!text) return bus::LabelSelector();
    auto selector = bus::LabelSelector::parse(*text);
    if (!selector) return failure(program::kExitUsage, "--selector: " + selector.error());
    return std::move(*selector);
}

Outcome<std::vector<KnownBoard>> choose_boards(BoardSource& source, const Target& target,
                                               const bus::LabelSelector& labels) {
    bus::Query query;
    query.board = target.board;
    query.service = target.service;
    query.labels = labels;
    auto boards = source.known_boards(std::move(query));
    if (boards && boards->empty()) {
        const auto with = labels.empty() ? std::string() : " with labels " + labels.text();
        return failure(program::kExitNoAnswer,
                       "no board is like " + target.text() + with + "; see asipctl list -o wide");
    }
    return boards;
}

Outcome<model::ServiceInfo> find_service(const KnownBoard& board, const std::string& name) {
    if (board.description) {
        for (const auto& service : board.description->services)
            if (service.name == name) return service;
        for (const auto& service : board.description->services)
            if (name.size() == 1 && service.id == name.front()) return service;
    }
    for (const auto& item : board.item.services) {
        if (item.name != name) continue;
        model::ServiceInfo service;
        service.name = name;
        return service;
    }
    const auto names = board.service_names();
    const auto all = listed(names);
    return failure(program::kExitFailure, board.item.board + " has no service '" + name + "'" +
                                              text::did_you_mean(name, names) + "; it has " +
                                              (all.empty() ? "none" : all));
}

Expected<std::vector<std::string>> split_words(std::string_view line) {
    std::vector<std::string> words;
    bool inside = false;
    char quote = '\0';
    for (const char c : line) {
        const bool blank = c == ' ' || c == '\t' || c == '\r';
        if (quote == '\0' && blank) {
            inside = false;
            continue;
        }
        if (!inside) words.emplace_back();
        inside = true;
        if (quote != '\0' && c == quote)
            quote = '\0';
        else if (quote == '\0' && (c == '"' || c == '\'') && words.back().find('{') != 0)
            quote = c;
        else
            words.back() += c;
    }
    if (quote != '\0') return fail("a quote is never closed");
    return words;
}

}  // namespace asip::cli
