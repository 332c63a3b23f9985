// SPDX-License-Identifier: Apache-2.0
#include "cli/find/chosen_boards.hpp"

namespace asip::cli {

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

}  // namespace asip::cli
