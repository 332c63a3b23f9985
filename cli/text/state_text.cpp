// SPDX-License-Identifier: Apache-2.0
#include "cli/text/state_text.hpp"

#include <chrono>

#include "asip/model/board_state.hpp"
#include "asip/text/duration.hpp"

namespace asip::cli {

std::string state_text(std::string_view state, std::string_view reason, double age_seconds) {
    std::string result(state);
    // An event that ends what was; a condition that lasts.
    const auto known = model::board_state_from_text(state);
    const bool ended = known && !model::is_there(*known);
    const auto words = model::words_of(model::state_reason_from_text(reason));
    if (!ended && words.empty()) return result;
    if (age_seconds >= 0) {
        const auto age = text::duration_text(std::chrono::duration<double>(age_seconds));
        result += ended ? " " + age + " ago" : " for " + age;
    }
    if (!words.empty()) result.append(": ").append(words);
    return result;
}

std::string state_text(const bus::BoardItem& board) {
    return state_text(board.state, board.reason, board.state_age);
}

std::string what_to_do(const bus::BoardItem& board) {
    switch (model::state_reason_from_text(board.reason)) {
        case model::StateReason::kUnplugged:
            return "plug it in again: its agent waits for it";
        case model::StateReason::kSilent:
            return "check its power, reset it, look at its sketch: its agent asks it again and again";
        case model::StateReason::kReleased:
            return "its agent takes the port back by itself; asipctl show " + board.board + " says when";
        default:
            return "start its agent again, or: asipctl forget " + board.board;
    }
}

}  // namespace asip::cli
