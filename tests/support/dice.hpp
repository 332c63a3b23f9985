// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <iterator>
#include <random>

namespace asip::test {

/// All that is random in a test. The same seed gives the same draws on every machine.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : engine_(seed) {}

    std::uint64_t draw() { return engine_(); }
    /// 0 to `end` - 1.
    std::uint64_t below(std::uint64_t end) { return draw() % end; }
    std::int64_t between(std::int64_t low, std::int64_t high) {
        return low + static_cast<std::int64_t>(below(static_cast<std::uint64_t>(high - low + 1)));
    }
    bool chance(double probability) {
        return probability > 0 && static_cast<double>(draw() >> 11) * 0x1.0p-53 < probability;
    }
    template <class Container>
    const auto& one_of(const Container& container) {
        return container[below(std::size(container))];
    }

  private:
    std::mt19937_64 engine_;
};

}  // namespace asip::test
