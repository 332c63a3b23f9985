// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <memory>
#include <memory_resource>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

/// The rows of an answer to a brief query: boards with only what a table shows, for catalogues of thousands.
/// On the wire each is an array, read by position; elements behind those known here are passed over:
///     [BOARD, STATE, AGE, CHIP, SKETCH, SERVICES, CONFLICT, REASON, FOR]
/// CONFLICT may be missing: false. So may both REASON (of the state) and FOR (seconds it has been in it).
namespace asip::bus {

/// One row. The members are those of BoardItem. The texts belong to the BriefRows it is in, or to the
/// caller that made it.
struct BriefBoard {
    std::string_view board;
    std::string_view state;  ///< effective
    double age = 0;          ///< seconds since anything was heard from it; negative: unknown
    std::string_view chip;
    std::string_view sketch;
    std::string_view services;  ///< names with a blank between them
    bool conflict = false;
    std::string_view reason{};  ///< of the state; empty: nothing to explain, or not known
    double state_age = -1;      ///< where there is a reason: seconds in the state; negative: unknown

    bool operator==(const BriefBoard&) const = default;
    /// Whether nothing but name, state and age differs, of a row in the same BriefRows, and no state has a
    /// reason; false is a maybe.
    bool like(const BriefBoard& other) const;
};

/// Rows and their texts. Copies share the texts: all of them belong to one thread.
class BriefRows {
  public:
    /// Copies the texts; one that the row before has, too, is kept once, as most boards of a fleet are alike.
    void add(const BriefBoard& row);
    void reserve(std::size_t rows) { rows_.reserve(rows); }

    /// May be put in another order, and thinned out.
    std::vector<BriefBoard>& rows() { return rows_; }
    const std::vector<BriefBoard>& rows() const { return rows_; }
    std::size_t size() const { return rows_.size(); }
    bool empty() const { return rows_.empty(); }

    bool operator==(const BriefRows& other) const { return rows_ == other.rows_; }

  private:
    std::string_view kept(std::string_view text, std::string_view above);

    std::vector<BriefBoard> rows_;
    std::shared_ptr<std::pmr::monotonic_buffer_resource> texts_;
};

/// Appends the JSON text of the rows, an array. Bytes that are not UTF-8 become U+FFFD; ages are cut to
/// milliseconds.
void append_brief_rows(std::string& text, const BriefRows& boards);

/// Reads the JSON text of rows. Fails with the number of the first row that is not one. Memory is bounded:
/// never more rows than bytes / 14.
Expected<BriefRows> read_brief_rows(std::string_view rows);

/// A brief answer taken apart.
struct BriefSplit {
    std::string envelope;  ///< the answer without its member "items"
    Expected<BriefRows> rows;
};

/// Nothing when `payload` is not well-formed, or not an answer that is marked as brief.
std::optional<BriefSplit> split_brief(std::string_view payload);

}  // namespace asip::bus
