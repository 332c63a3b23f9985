// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>

#include "cli/commands/list.hpp"

namespace asip::cli {

/// `asipctl list -w`: the list, then each board or service that changes, as one more row (or JSON line),
/// until Ctrl-C.
int run_watch(const ListOptions& options, Environment& environment);

/// Decides which rows a watcher sees: what differs from what was shown of the board last. Pure.
class ChangePrinter {
  public:
    ChangePrinter(const ListOptions& options, std::size_t width, bool colour);

    /// Text to print for a board as it is now; empty when nothing that is shown changed.
    std::string changed(const bus::BoardItem& seen);
    /// Text for a board that is forgotten.
    std::string gone(const std::string& board);

  private:
    std::string rows(const bus::BoardItem& board);
    std::string records(const bus::BoardItem& board) const;
    std::string names(const bus::BoardItem& board) const;

    const ListOptions& options_;
    std::size_t width_;
    bool colour_;
    Table table_;
    bool first_ = true;
    std::map<std::string, std::string> shown_;
};

}  // namespace asip::cli
