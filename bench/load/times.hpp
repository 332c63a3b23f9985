// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "asip/time.hpp"

namespace asip::load {

/// How long something took, many times: counted in classes that differ by 2.2 %, from a microsecond to more
/// than an hour. Of constant size.
class Times {
  public:
    /// Times outside of the classes count in the first or the last of them.
    void add(Duration time);
    std::uint64_t count() const { return count_; }
    /// Seconds that the part `share` (0 to 1) of all did not exceed; 0 where there are none.
    double seconds(double share) const;
    /// Exact, not by its class.
    double longest_seconds() const { return std::chrono::duration<double>(longest_).count(); }

  private:
    static constexpr std::size_t kPerDoubling = 32;
    static constexpr std::size_t kClasses = 32 * kPerDoubling;
    std::array<std::uint32_t, kClasses> classes_{};
    std::uint64_t count_ = 0;
    Duration longest_{};
};

}  // namespace asip::load
