// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "registry/history/history.hpp"

namespace asip::registry {

/// Moves a damaged file, with what SQLite has beside it, to FILE.damaged (then .damaged-2 to -9), and says
/// where. Empty: it cannot be moved, or too many lie there already.
std::string put_aside(const std::string& path);

/// A history file that may be missing, damaged, locked, full or forbidden for a while: opened when it is
/// needed, closed after a fault, so that the next use begins anew. A damaged file is put aside
/// and a new one is made. Blocks, as History does.
class HistoryStore {
  public:
    /// What a file holds that was opened.
    struct Opened {
        JournalBoards boards{};
        std::optional<KeptTime::Mark> mark{};
        bool made = false;    ///< there was nothing in it
        std::string aside{};  ///< where the damaged one is; empty: there was none
        std::string damage{};
    };
    /// What became of one use of the file.
    struct Outcome {
        std::string fault;             ///< empty: all was done
        std::optional<Opened> opened;  ///< where this use opened the file
    };
    /// `opened`: null where it was open already. May throw HistoryFault.
    using Use = std::function<void(History& history, const Opened* opened)>;

    explicit HistoryStore(History::Options options) : options_(std::move(options)) {}

    /// After a fault each further use fails with it, until retry().
    Outcome run(const Use& use);
    void retry() { fault_.clear(); }
    const History::Options& options() const { return options_; }

  private:
    Outcome attempt(const Use& use);
    void open(Outcome& outcome);
    const History::Options options_;
    std::unique_ptr<History> history_;
    std::string fault_;
};

}  // namespace asip::registry
