// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/time.hpp"

namespace asip::agent {

/// What goes over the line of a board, as long as somebody watches it: the bytes of both directions with
/// their times, a few times a second, within a bound. Pure.
class LineWatch {
  public:
    static constexpr Duration kBetween = std::chrono::milliseconds(200);
    static constexpr Duration kTogether = std::chrono::milliseconds(5);  ///< bytes that make one piece
    static constexpr std::size_t kMaxBytes = std::size_t{4} * 1024;      ///< in each of these times

    void watch_until(Time until) { until_ = std::max(until_, until); }
    void received(std::string_view bytes, Time now) { add('<', bytes, now); }
    void sent(std::string_view bytes, Time now) { add('>', bytes, now); }
    std::optional<Time> next_deadline() const { return pieces_.empty() ? std::nullopt : std::optional(due_); }
    /// JSON: `{"line":[["<",AGE,"@D,e,.."],[">",AGE,"D,M\n"]],"dropped":12}`. AGE is in seconds. A byte is
    /// the character with its number, 0 to 255. `dropped` counts the bytes beyond the bound. Empty: it is not
    /// time yet.
    std::string take(Time now);

  private:
    struct Piece {
        char direction;
        Time at;
        std::string bytes;
    };
    void add(char direction, std::string_view bytes, Time now);

    Time until_{};
    Time due_{};
    Time told_{};
    std::vector<Piece> pieces_;
    std::size_t kept_ = 0;
    std::size_t dropped_ = 0;
};

}  // namespace asip::agent
