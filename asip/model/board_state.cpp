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

}  // namespace

std::string_view to_text(BoardState state) {
    for (const auto& [value, text] : kTexts) {
        if (value == state) return text;
    }
    return "offline";
}

std::optional<BoardState> board_state_from_text(std::string_view text) {
    for (const auto& [value, word] : kTexts) {
        if (word == text) return value;
    }
    return std::nullopt;
}

}  // namespace asip::model
