#include "cli/change_record.hpp"

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

std::vector<Cell> change_row(const bus::HistoryItem& change) {
    return {text::iso_time(change.at),
            change.board,
            change.what,
            Cell(change.state, state_colour(change.state)),
            change.was,
            change.reason};
}

std::vector<std::string> change_fields() {
    return {"board", "at", "what", "state", "was", "reason"};
}

}  // namespace asip::cli
