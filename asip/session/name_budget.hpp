// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <string_view>

#include "asip/time.hpp"

namespace asip::session {

/// How often a board may be given a name: each write wears its EEPROM, whose cells last for 100,000. kAtOnce
/// names, then one each kEvery. Pure.
class NameBudget {
  public:
    static constexpr unsigned kAtOnce = 10;
    static constexpr Duration kEvery = std::chrono::minutes(10);

    /// The line stores a name: `#,I,NAME`.
    static bool concerns(std::string_view line) { return line.starts_with("#,I,"); }

    unsigned left(Time now) const {
        if (!begun_) return kAtOnce;
        const auto back = static_cast<unsigned>(std::min<Duration::rep>((now - since_) / kEvery, kAtOnce));
        return std::min(left_ + back, kAtOnce);
    }
    void spend(Time now) {
        const auto before = left(now);
        since_ = before == kAtOnce ? now : since_ + kEvery * (before - left_);
        left_ = before - 1;
        begun_ = true;
    }

  private:
    unsigned left_ = kAtOnce;
    Time since_{};
    bool begun_ = false;
};

}  // namespace asip::session
