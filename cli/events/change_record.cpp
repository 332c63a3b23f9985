// SPDX-License-Identifier: Apache-2.0
#include "cli/events/change_record.hpp"

#include "asip/model/board_state.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/commands/list.hpp"

namespace asip::cli {

bus::HistoryItem change_of(const bus::ChangeEvent& event) {
    bus::HistoryItem change;
    change.board = event.board.board;
    change.at = event.at;
    change.what = bus::to_string(event.kind);
    change.state = event.board.state;
    change.was = event.was;
    change.reason = event.reason;
    return change;
}

Table change_table() {
    return Table({{"TIME"}, {"BOARD"}, {"WHAT"}, {"STATE"}, {"BEFORE"}, {"REASON", false, 8}});
}

namespace {

// "anna: servo {"write":[0,90]}, 12 times; queue-full"; "io {"write":[5,1]}, by link warm, because
// desk/temperature was 30.5"
std::string command_words(const bus::HistoryItem& command) {
    const bool link = command.by.starts_with("link ");
    std::string words = link ? std::string() : command.by + ":";
    for (const auto& part : {command.service, command.request})
        if (!part.empty()) words += (words.empty() ? "" : " ") + part;
    if (link) words += ", by " + command.by;
    if (command.count > 1) words += ", " + std::to_string(command.count) + " times";
    return command.reason.empty() ? words : words + "; " + command.reason;
}

std::string reason_words(const std::string& reason) {
    const auto words = model::words_of(model::state_reason_from_text(reason));
    return words.empty() ? reason : std::string(words);
}

}  // namespace

std::vector<Cell> change_row(const bus::HistoryItem& change) {
    if (change.is_command())
        return {text::iso_time(change.at), change.board, change.what, change.status, "",
                command_words(change)};
    return {text::iso_time(change.at),
            change.board,
            change.what,
            Cell(change.state, state_colour(change.state)),
            change.was,
            reason_words(change.reason)};
}

std::vector<std::string> change_fields() {
    return {"board", "at", "what", "state", "was", "reason", "by", "service", "request", "status", "count"};
}

}  // namespace asip::cli
