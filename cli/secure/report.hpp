// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

/// A line each, and what to do next.
class SecureReport {
  public:
    SecureReport(const OutputOptions& options, Environment& environment)
        : options_(options),
          out_(environment.out),
          records_(options, RecordPrinter::Count::kList, environment.out) {}

    /// `made`, `kept`, `changed`, `removed`, `moved`, `gave`, `cleared`, `reloaded`, `restarted` or
    /// `warning`.
    void did(const std::string& action, const std::string& what, const std::string& file = {});
    /// A command to run (or a file to copy), and why.
    void next(const std::string& why, const std::string& command = {});
    void finish();
    bool changed() const { return changed_; }

  private:
    const OutputOptions& options_;
    std::ostream& out_;
    RecordPrinter records_;
    std::string next_;
    bool changed_ = false;
};

}  // namespace asip::cli
