// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/pattern.hpp"
#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"

namespace asip::bus {

// The one place that decides it: for programs that read the bus itself, and for a registry where no index
// answers.

/// The texts are the caller's, for the duration of a call.
struct BoardFacts {
    std::string_view board;
    std::string_view state;  ///< effective
    std::string_view chip;
    std::string_view sketch;
    unsigned capabilities = 0;  ///< of all its pins together: 1 digital, 2 analog, 4 PWM
    const std::map<std::string, std::string>* labels = nullptr;  ///< null: none
};

/// The bit of "digital", "analog" or "pwm"; 0: another word.
inline unsigned capability_bit(std::string_view word) {
    return word == "digital" ? 1 : word == "analog" ? 2 : word == "pwm" ? 4 : 0;
}

/// Also where `wanted` is empty.
inline bool is_among(const std::vector<std::string>& wanted, std::string_view value) {
    return wanted.empty() || std::find(wanted.begin(), wanted.end(), value) != wanted.end();
}

/// By `board`, `state`, `chip`, `sketch`, `capability`, `labels`.
inline bool matches_board(const Query& query, const BoardFacts& board) {
    if (!is_among(query.state, board.state) || !matches_pattern(query.board, board.board)) return false;
    if (!query.chip.empty() && !matches_pattern(query.chip, board.chip)) return false;
    if (!query.sketch.empty() && !matches_pattern(query.sketch, board.sketch)) return false;
    if (!query.labels.empty()) {
        static const std::map<std::string, std::string> kNone;
        if (!query.labels.matches(board.labels != nullptr ? *board.labels : kNone)) return false;
    }
    return query.capability.empty() || (board.capabilities & capability_bit(query.capability)) != 0;
}

/// By `service`, `kind`, `unit`. `has_unit(unit)`: a field of the service's events or commands has it.
template <class HasUnit>
bool matches_service(const Query& query, std::string_view name, std::string_view kind,
                     const HasUnit& has_unit) {
    return is_among(query.kind, kind) && matches_pattern(query.service, name) &&
           (query.unit.empty() || has_unit(query.unit));
}

/// The query has a filter on services: a board needs one that matches.
inline bool asks_for_services(const Query& query) {
    return !query.service.empty() || !query.kind.empty() || !query.unit.empty();
}

/// A board, or a service of it, passes all filters of `query`. `description` may be null; `models` gives the
/// units of standard models.
bool board_matches(const Query& query, const BoardItem& board, const model::Description* description,
                   const model::ModelSet& models);
bool service_matches(const Query& query, const ServiceItem& service, const model::Description* description,
                     const model::ModelSet& models);

/// Its own, the standard one that it refers to (in any version), or what letter and title suggest; may be
/// null.
model::ModelPtr model_of(const model::ServiceInfo& service, const model::ModelSet& models);

}  // namespace asip::bus
