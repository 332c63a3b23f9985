// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <map>
#include <string>

#include "asip/time.hpp"

namespace asip::gateway {

/// How often each of several names does something: `per_second` on average, twice as many at once. Names that
/// have done nothing for a minute are forgotten by expire(). Pure.
class Rates {
  public:
    /// `per_second`: above 0.
    explicit Rates(double per_second) : per_second_(per_second) {}

    /// Counts one; false: too many.
    bool take(const std::string& name, Time now) {
        auto& bucket = buckets_.try_emplace(name, Bucket{2 * per_second_, now}).first->second;
        const std::chrono::duration<double> passed = now - bucket.at;
        bucket.left = std::min(2 * per_second_, bucket.left + passed.count() * per_second_);
        bucket.at = now;
        if (bucket.left < 1) return false;
        bucket.left -= 1;
        return true;
    }
    /// Forgets clients that have done nothing for a while.
    void expire(Time now) {
        std::erase_if(buckets_,
                      [&](const auto& each) { return now - each.second.at > std::chrono::minutes(1); });
    }

  private:
    struct Bucket {
        double left;
        Time at;
    };
    double per_second_;
    std::map<std::string, Bucket> buckets_;
};

}  // namespace asip::gateway
