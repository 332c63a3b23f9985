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

/// Brokers that acknowledge late: holds what was published with QoS 1, and says when the broker took too
/// long. The time stands still while the broker sends answers to subscriptions and retained messages. Pure.
class Acknowledgements {
  public:
    /// Unless the broker allows fewer: libmosquitto and Mosquitto allow no more.
    static constexpr std::size_t kMax = 20;

    /// Zero: for ever.
    explicit Acknowledgements(Duration limit) : limit_(limit) {}

    void sent(int id, Outbox::Entry entry, Time now) { waiting_.emplace(id, Waiting{std::move(entry), now}); }
    /// None: it is not waited for.
    std::optional<Outbox::Entry> answered(int id) {
        auto found = waiting_.extract(id);
        if (found.empty()) return std::nullopt;
        return std::move(found.mapped().entry);
    }
    /// The broker is busy with something else, or its bytes wait to be read.
    void busy(Time now) { busy_ = now; }
    bool overdue(Time now) const {
        return limit_ != Duration::zero() &&
               std::any_of(waiting_.begin(), waiting_.end(), [&](const auto& each) {
                   return now - std::max(each.second.sent, busy_) >= limit_;
               });
    }
    std::size_t size() const { return waiting_.size(); }
    /// The connection has ended: calls `put_back` with each message, and forgets them.
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
