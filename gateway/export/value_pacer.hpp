// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "asip/time.hpp"

namespace asip::gateway::exports {

/// What was published on a state topic, and what waits. The newest value is always published last. Pure.
class PacedValue {
  public:
    /// The broker keeps it of an earlier time.
    void adopt(std::string text) {
        sent_ = std::move(text);
        sent_at_.reset();
    }
    /// True: publish sent() at once. False: it is there already, or waits().
    bool offer(std::string text, Time now, Duration between, bool room) {
        if (text == sent_) {
            waiting_.reset();
            return false;
        }
        waiting_ = std::move(text);
        return take(now, between, room);
    }
    /// True: what waited is sent() now.
    bool take(Time now, Duration between, bool room) {
        if (!waiting_ || !room || (sent_at_ && now - *sent_at_ < between)) return false;
        sent_ = std::move(*waiting_);
        waiting_.reset();
        sent_at_ = now;
        return true;
    }
    bool waits() const { return waiting_.has_value(); }
    /// The broker keeps an older value than the known one.
    bool is_outdated() const { return waiting_ && !sent_at_; }
    const std::string& sent() const { return sent_; }
    /// What waits, else what was sent.
    const std::string& newest() const { return waiting_ ? *waiting_ : sent_; }

  private:
    std::string sent_;  // empty: nothing
    std::optional<std::string> waiting_;
    std::optional<Time> sent_at_;
};

/// Lines of the log that others can cause: one a minute for each subject, with how often it came. Pure.
class Seldom {
  public:
    static constexpr Duration kBetween = std::chrono::minutes(1);
    static constexpr std::size_t kMaxSubjects = 1000;  ///< all others are one

    explicit Seldom(std::function<void(const std::string&)> log) : log_(std::move(log)) {}

    void say(std::string subject, const std::string& sentence, Time now) {
        if (said_.size() >= kMaxSubjects && !said_.contains(subject)) subject.clear();
        const auto [found, first] = said_.try_emplace(std::move(subject), Said{now, 0, {}});
        if (first) return log_(sentence);
        ++found->second.more;
        found->second.sentence = sentence;
    }
    void tick(Time now) {
        for (auto each = said_.begin(); each != said_.end();) {
            auto& said = each->second;
            if (now - said.at < kBetween) {
                ++each;
            } else if (said.more == 0) {
                each = said_.erase(each);
            } else {
                log_(said.sentence + " (" + std::to_string(std::exchange(said.more, 0)) + " in a minute)");
                said.at = now;
                ++each;
            }
        }
    }

  private:
    struct Said {
        Time at;
        std::uint64_t more;
        std::string sentence;  // the last one
    };
    std::function<void(const std::string&)> log_;
    std::map<std::string, Said> said_;
};

}  // namespace asip::gateway::exports
