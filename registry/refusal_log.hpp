// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "asip/mqtt/message.hpp"
#include "registry/catalogue_types.hpp"

namespace asip::registry {

/// Decides which refused messages are logged: each reason once a board, and no replays.
class RefusalLog {
  public:
    static constexpr std::size_t kMaxLines = 1000;

    struct Line {
        std::string reason;
        std::string topic;
        std::string payload;  ///< its beginning
        std::string where;    ///< in a description: the member that is wrong; else empty
    };

    /// `board`: as in the topic; may be empty.
    std::optional<Line> refused(const mqtt::Message& message, std::string_view board, Refusal refusal);

  private:
    std::set<std::string> logged_;
};

}  // namespace asip::registry
