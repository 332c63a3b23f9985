// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace asip::cli {

/// The newest report of each service of one board, as one line. Pure.
class ShellValues {
  public:
    /// The services of the board, in the order in which they are shown. What is kept of others goes.
    void services(std::vector<std::string> names);
    /// A report. `what` tells kinds of report of a service apart; each replaces the one before of its kind.
    /// At most 8 kinds of a service are kept. False: nothing that is shown has changed.
    bool report(const std::string& service, const std::string& what, std::string text);

    /// Only these services; none: all of them.
    void select(std::vector<std::string> names) { selected_ = std::move(names); }
    void show(bool on) { shown_ = on; }
    bool shown() const { return shown_; }

    /// At most `columns` wide; empty where there is nothing to show.
    std::string line(std::size_t columns) const;

  private:
    bool wanted(const std::string& service) const;

    bool shown_ = true;
    std::vector<std::string> order_, selected_;
    std::map<std::string, std::map<std::string, std::string>> reports_;
};

}  // namespace asip::cli
