// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "agent/counts/allowance.hpp"
#include "asip/program/log.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Lines of the log for the bus: kBurst at once, then kPerSecond, and the newest kMaxKept until they are
/// taken. The next line counts what was dropped. Pure.
class LogFeed {
  public:
    static constexpr double kBurst = 50;
    static constexpr double kPerSecond = 5;
    static constexpr std::size_t kMaxKept = 32;
    static constexpr std::size_t kMaxTextBytes = 512;

    /// `time`: of day, as text.
    void add(program::log::Level level, std::string_view text, std::span<const program::log::Field> fields,
             const std::string& time, Time now);
    /// JSON texts, in order. Nothing is kept.
    std::vector<std::string> take();

  private:
    std::deque<std::string> kept_;
    Allowance allowance_{kBurst, kPerSecond};
};

}  // namespace asip::agent
