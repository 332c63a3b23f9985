// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "registry/catalogue_types.hpp"

namespace asip::registry {

/// When something happened: by the clock of this machine, for people, and as KeptTime has it, for ages.
struct Stamp {
    Stamp(text::WallTime time, std::chrono::milliseconds kept_time = {}) : wall(time), kept(kept_time) {}
    text::WallTime wall;
    std::chrono::milliseconds kept;
};

/// What a history knows of a board.
struct JournalBoard {
    text::WallTime first{};  ///< when it was added
    text::WallTime since{};  ///< when it came into `state`
    model::BoardState state = model::BoardState::kLost;
    std::chrono::milliseconds first_kept{};
    std::chrono::milliseconds since_kept{};

    bool operator==(const JournalBoard&) const = default;
};
using JournalBoards = std::map<std::string, JournalBoard, std::less<>>;

/// Decides which rows a history gets. A registry that starts or connects again learns of every board anew;
/// that is not a change and leaves no row. What did change meanwhile is found by comparing once the catalogue
/// is complete. Pure.
class Journal {
  public:
    using Rows = std::vector<bus::HistoryItem>;

    explicit Journal(JournalBoards known) : known_(std::move(known)) {}

    /// What is known of a board; null: nothing. Valid until the next call that changes the journal.
    const JournalBoard* find(std::string_view board) const;

    /// The catalogue is being read from the broker: its changes are not written until complete().
    void begin_reading() { reading_ = true; }
    /// The catalogue is complete: rows for what differs from what is known.
    void complete(const Catalogue& catalogue, Stamp at, Rows& rows);
    /// Rows for a change. Events that are not changes are ignored.
    void change(const Event& event, Stamp at, Rows& rows);
    /// A row for what an agent published of a command, or one more in `count` of a row of the same sender,
    /// service, command and outcome among the last in `rows`. Nothing for a board that is not known, for one
    /// without a sender, or for what is none. Any bytes may be given.
    void command(std::string_view board, std::string_view payload, text::WallTime at, Rows& rows) const;
    /// Rows for the boards that are known as alive and of which the catalogue has heard nothing. To be called
    /// a lease after complete(): boards that take part by names only send nothing earlier.
    void end_absent(const Catalogue& catalogue, Stamp at, Rows& rows);

    /// What a file knows that could be read only now. `rows` wait for it since this journal began: what they
    /// add, though the file has it, is no change. `shift`: of the kept times given so far.
    void load(JournalBoards known, std::chrono::milliseconds shift, Rows& rows);
    const JournalBoards& boards() const { return known_; }

  private:
    void added(std::string_view board, model::BoardState state, std::string_view reason, Stamp at,
               Rows& rows);
    void came_into(const std::string& board, JournalBoard& known, model::BoardState state,
                   std::string_view reason, Stamp at, Rows& rows);

    JournalBoards known_;
    bool reading_ = true;
};

}  // namespace asip::registry
