// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "tests/truth/exhaustive/fingerprint.hpp"
#include "tests/truth/exhaustive/trial.hpp"

namespace truth {

/// Parts of a state at a time, as they go into its fingerprint.
class StateParts {
  public:
    /// `exact`: how long ago something was counts exactly, also where it was lately.
    StateParts(Fingerprint& print, Micros now, bool exact) : now_(now), exact_(exact), print_(print) {}

    /// Something was lately.
    bool is_recent() const { return recent_; }

    template <class T>
        requires std::is_integral_v<T> || std::is_enum_v<T>
    void add(T value) {
        print_.add(value);
    }
    void add(std::string_view text) { print_.add(text); }
    void add(const std::string& text) { print_.add(std::string_view(text)); }
    void add(asip::Duration time) { print_.add(time.count()); }
    void add(asip::Time time) {
        const bool is_time = time != asip::Time::max() && time != asip::Time::min() && time != asip::Time{};
        print_.add(is_time ? (time - present()).count() : time.time_since_epoch().count() ^ 1);
    }
    template <class T>
    void add(const std::optional<T>& value) {
        add(value.has_value());
        if (value) add(*value);
    }
    template <class A, class B>
    void add(const std::pair<A, B>& both) {
        add(both.first);
        add(both.second);
    }
    template <class List>
        requires requires(const List& list) { list.begin(), list.size(); }
    void add(const List& list) {
        add(list.size());
        for (const auto& one : list)
            add(one);
    }
    asip::Time present() const {
        return asip::Time{} + std::chrono::hours(1) + std::chrono::microseconds(now_);
    }
    /// A time in microseconds.
    void at(Micros time) { add(time == kNever ? time : time - now_); }
    /// One that does not count once it is over.
    void until(Micros time) { add(time == kNever ? time : std::max<Micros>(time - now_, 0)); }
    /// One of which only counts whether it was long ago (kRecent).
    void lately(Micros time) {
        const Micros age = now_ - time;
        const bool recent = !exact_ && age >= 0 && age < kRecent;
        recent_ = recent_ || recent;
        add(recent ? Micros{0} : age);
    }
    void add(const Effect& effect) {
        add(effect.kind);
        add(effect.subject);
        add(effect.value);
    }

  protected:
    const Micros now_;

  private:
    const bool exact_;
    bool recent_ = false;
    Fingerprint& print_;
};

}  // namespace truth
