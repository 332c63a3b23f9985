// SPDX-License-Identifier: Apache-2.0
#include "asip/model/board_state.hpp"

#include <array>
#include <utility>

namespace asip::model {
namespace {

constexpr std::array<std::pair<BoardState, std::string_view>, 5> kTexts = {{
    {BoardState::kOnline, "online"},
    {BoardState::kOffline, "offline"},
    {BoardState::kLost, "lost"},
    {BoardState::kSleeping, "sleeping"},
    {BoardState::kUpdating, "updating"},
}};

struct ReasonText {
    StateReason reason;
    std::string_view word;
    std::string_view words;
};
constexpr std::array<ReasonText, 9> kReasons = {{
    {StateReason::kNone, "", ""},
    {StateReason::kUnplugged, "unplugged", "cable unplugged"},
    {StateReason::kSilent, "silent", "the board answers nothing"},
    {StateReason::kAgentGone, "agent-gone", "its agent died or lost the broker"},
    {StateReason::kExpired, "expired", "its agent fell silent and the lease ran out"},
    {StateReason::kReleased, "released", "its port is in other hands"},
    {StateReason::kStopped, "stopped", "its agent was stopped"},
    {StateReason::kConflict, "conflict", "two agents claim its name"},
    {StateReason::kLatched, "latched", "STOPPED until it is resumed"},
}};

}  // namespace

std::string_view to_text(BoardState state) {
    for (const auto& [value, text] : kTexts)
        if (value == state) return text;
    return "offline";
}

std::optional<BoardState> board_state_from_text(std::string_view text) {
    for (const auto& [value, word] : kTexts)
        if (word == text) return value;
    return std::nullopt;
}

bool is_gone(std::string_view word) {
    const auto state = board_state_from_text(word);
    return state && !is_there(*state);
}

bool takes_commands(std::string_view word) {
    const auto state = board_state_from_text(word);
    return state && is_there(*state) && *state != BoardState::kUpdating;
}

std::string_view to_text(StateReason reason) {
    for (const auto& each : kReasons)
        if (each.reason == reason) return each.word;
    return {};
}

StateReason state_reason_from_text(std::string_view text) {
    for (const auto& each : kReasons)
        if (each.word == text) return each.reason;
    return StateReason::kNone;
}

std::string_view words_of(StateReason reason) {
    for (const auto& each : kReasons)
        if (each.reason == reason) return each.words;
    return {};
}

}  // namespace asip::model
