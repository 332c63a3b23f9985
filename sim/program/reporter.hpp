// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "sim/board.hpp"

namespace asip::sim {

/// "uno1 1.234567 led13 on", or a JSON object. Called from the boards' threads.
class Reporter {
  public:
    enum class Format { kText, kJson };
    /// `write_line`: without line end, one call at a time.
    Reporter(Format format, std::function<void(std::string_view)> write_line);

    void changed(const std::string& board, const Change& change);
    /// "reset", "unplugged". The values of `details` follow in the text.
    void happened(const std::string& board, SimTime time, std::string_view event,
                  const nlohmann::ordered_json& details);

  private:
    void write(const std::string& line);

    Format format_;
    std::function<void(std::string_view)> write_line_;
    std::mutex mutex_;
};

}  // namespace asip::sim
