#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/items.hpp"
#include "asip/bus/query.hpp"
#include "asip/expected.hpp"

namespace asip::bus {

/// An answer to a query or a forget. An error has `refused` set and nothing else but `id` and `registry`.
struct Answer {
    std::string id;         ///< of the request
    std::string registry;   ///< who answers
    std::string epoch;      ///< differs each time a registry starts counting anew
    std::uint64_t seq = 0;  ///< the items hold after exactly the change events of `epoch` up to this number
    bool settling = false;  ///< the registry is still reading what the broker retains: more will come
    Find find = Find::kBoards;         ///< what the items are, also where there are none
    std::optional<std::size_t> total;  ///< all matches, where asked for or known anyway
    std::vector<BoardItem> boards;
    /// Set: the answer is to a brief query, and `boards` is empty. A registry that does not know brief
    /// queries answers with `boards`.
    std::optional<std::vector<BriefBoard>> brief;
    std::vector<ServiceItem> services;
    std::vector<HistoryItem> history;
    std::vector<std::string> forgotten;  ///< board names
    std::string cursor;                  ///< for the next page; empty: this was the last
    std::string refused;  ///< reason: "invalid", "alive", "unknown-board", "no-history", "too-many"
    std::string error;    ///< the reason in a sentence

    bool operator==(const Answer&) const = default;
};

std::string encode(const Answer& answer);
Expected<Answer> parse_answer(std::string_view payload);

}  // namespace asip::bus
