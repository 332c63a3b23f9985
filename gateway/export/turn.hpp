// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::gateway::exports {

/// Which of several gateways exports. It says so every few seconds on a retained topic; when it is silent, or
/// the broker says that it is gone, another takes over. The later term counts, then the smaller name. Pure.
class Turn {
  public:
    static constexpr Duration kRenewal = std::chrono::seconds(3);
    static constexpr Duration kStale = std::chrono::seconds(8);
    static constexpr Duration kSettle = std::chrono::seconds(1);  ///< until what is retained has come
    static constexpr std::size_t kMaxBytes = 1024;
    static constexpr std::size_t kMaxPlaces = 4;

    /// The gateway that exports, or did.
    struct Holder {
        std::string gateway;  ///< unique for each process
        std::uint64_t term = 0;
        std::string host;              ///< its machine
        std::set<std::string> places;  ///< where its documents are, or were
        friend bool operator==(const Holder&, const Holder&) = default;
    };

    /// Each claim sets `self.term`.
    Turn(Holder self, Random random) : self_(std::move(self)), random_(std::move(random)) {}

    /// To lease and state; what is retained follows.
    void subscribed(Time now);
    void disconnected() { heard_since_.reset(); }
    /// On the lease's topic. True: that ends our lease.
    bool said(std::string_view payload, bool retained, Time now);
    /// On the topic of the export's state: "online", or "offline" from the broker or at an end.
    void state(std::string_view payload, Time now);

    bool active() const { return active_; }
    /// None: no gateway ever held it.
    const std::optional<Holder>& holder() const { return holder_; }
    /// A holder lives, as far as can be known.
    bool held(Time now) const;
    /// No gateway holds it, and it is time to.
    bool may_claim(Time now) const;
    /// The last holder was on this machine, or `any`.
    bool may_clear(bool any, Time now) const {
        return may_claim(now) && (any || (holder_ && holder_->host == self_.host));
    }
    /// The term of the next claim.
    std::uint64_t next_term() const { return std::max(self_.term, holder_ ? holder_->term : 0) + 1; }
    /// Returns what to publish, retained.
    std::string claim(Time now);
    /// What to publish, retained, where it is ours and due.
    std::optional<std::string> renewal(Time now);
    /// The connection that carries it goes.
    void release() { active_ = false; }
    /// The only place of documents from now on; the next renewal says it.
    void set_place(const std::string& place) {
        const std::set<std::string> places{place};
        if (self_.places != places) renew_at_ = {};
        self_.places = places;
    }

  private:
    std::string text() const;

    Holder self_;
    Random random_;
    std::optional<Holder> holder_;
    std::optional<Time> heard_since_;
    Time last_sign_{};   // of the holder
    Time not_before_{};  // a claim
    bool holder_gone_ = false;
    bool active_ = false;
    Time renew_at_{};
};

}  // namespace asip::gateway::exports
