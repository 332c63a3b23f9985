// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

/// The rows of an answer to a brief query: boards with only what a table shows, for catalogues of thousands.
/// On the wire each is an array, read by position; elements behind those known here are passed over:
///     [BOARD, STATE, AGE, CHIP, SKETCH, SERVICES, CONFLICT]
/// CONFLICT may be missing: false.
namespace asip::bus {

/// One row. The members are those of BoardItem.
struct BriefBoard {
    std::string board;
    std::string state;  ///< effective
    double age = 0;     ///< seconds since anything was heard from it; negative: unknown
    std::string chip;
    std::string sketch;
    std::string services;  ///< names with a blank between them
    bool conflict = false;

    bool operator==(const BriefBoard&) const = default;
};

/// Appends the JSON text of the rows, an array. Bytes that are not UTF-8 become U+FFFD; ages are cut to
/// milliseconds.
void append_brief_rows(std::string& text, const std::vector<BriefBoard>& boards);

/// Reads the JSON text of rows. Fails with the number of the first row that is not one. Memory is bounded:
/// never more rows than bytes / 14.
Expected<std::vector<BriefBoard>> read_brief_rows(std::string_view rows);

/// A brief answer taken apart without reading its rows.
struct BriefSplit {
    std::string envelope;   ///< the answer without its member "items"
    std::string_view rows;  ///< the value of "items", checked to be JSON; lives as long as the payload
};

/// Nothing when `payload` is not well-formed, or not an answer that is marked as brief.
std::optional<BriefSplit> split_brief(std::string_view payload);

}  // namespace asip::bus
