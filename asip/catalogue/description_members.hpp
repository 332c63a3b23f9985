// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "asip/model/board_state.hpp"

namespace asip::catalogue {

/// The members of a description's outer object. The views point into the payload that was read.
struct DescriptionMembers {
    std::string_view board;
    std::string_view session;
    std::uint64_t seq = 0;
    std::uint64_t lease = 0;  // seconds; 0: absent
    std::string_view firmware;
    std::string_view pins;
    std::string_view services;
    std::string_view agent;
    std::string_view link;
    std::string_view labels;
    std::string_view names;
    std::optional<model::SaidState> state;
    std::string extra;  // all others with their keys, as received, joined by commas; labels and names, too
};

/// Texts that members are likely to have. A member that is equal to its guess is not parsed again.
struct Guesses {
    std::string_view firmware;
    std::string_view pins;
    std::string_view services;
    std::string_view agent;
    std::string_view link;
};

/// False if `payload` is not a JSON object with board, session, seq and services of the right types, or has
/// one of these members twice. Names are not checked here.
bool read_description(std::string_view payload, const Guesses& guesses, DescriptionMembers& members);

}  // namespace asip::catalogue
