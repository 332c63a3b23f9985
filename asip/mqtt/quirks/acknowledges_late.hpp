// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "asip/mqtt/outbox.hpp"
#include "asip/time.hpp"

namespace asip::mqtt {

/// A broker that acknowledges late: holds what was published with QoS 1 until the broker acknowledges it, and
/// says when the broker has had too much time. The time stands still while the broker is busy with something
/// that it sends first: answers to subscriptions and the retained messages behind them. Pure.
class Acknowledgements {
  public:
    /// How many messages may wait, unless the broker allows fewer: libmosquitto and Mosquitto allow no more.
    static constexpr std::size_t kMax = 20;

    /// `limit`: how long an acknowledgement may take; zero: for ever.
    explicit Acknowledgements(Duration limit) : limit_(limit) {}

    void sent(int id, Outbox::Entry entry, Time now) { waiting_.emplace(id, Waiting{std::move(entry), now}); }
    /// The message of that packet; none if it is not waited for.
    std::optional<Outbox::Entry> answered(int id) {
        auto found = waiting_.extract(id);
        if (found.empty()) return std::nullopt;
        return std::move(found.mapped().entry);
    }
    /// The broker is busy with something else, or what it sent has not been read yet.
    void busy(Time now) { busy_ = now; }
    bool overdue(Time now) const {
        return limit_ != Duration::zero() &&
               std::any_of(waiting_.begin(), waiting_.end(), [&](const auto& each) {
                   return now - std::max(each.second.sent, busy_) >= limit_;
               });
    }
    std::size_t size() const { return waiting_.size(); }
    /// Calls `put_back` with each message, and forgets them: the connection has ended.
    template <class PutBack>
    void drain(PutBack put_back) {
        for (auto& [id, each] : std::exchange(waiting_, {}))
            put_back(std::move(each.entry));
    }

  private:
    struct Waiting {
        Outbox::Entry entry;
        Time sent;
    };
    Duration limit_;
    std::map<int, Waiting> waiting_;
    Time busy_{};
};

}  // namespace asip::mqtt
