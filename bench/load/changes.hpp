// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "bench/load/times.hpp"

namespace asip::load {

/// What one watcher knows of the numbers of one registry's events.
struct EventNumbers {
    std::uint64_t resets = 0;    ///< beyond the one of each connection of the registry
    std::uint64_t gaps = 0;      ///< places where the numbers do not go on by one
    std::uint64_t left_out = 0;  ///< numbers that are missing there
    // The last event's; no epoch: none was received.
    std::string epoch{};
    std::uint64_t seq = 0;

    /// The number of an event. A new epoch begins anew, with its first number.
    void take(const std::string& of_epoch, std::uint64_t number, bool reset);
    /// The watcher's connection was lost: what it missed meanwhile does not count.
    void forget() { epoch.clear(); }
};

/// What many watchers received of one registry.
struct SeenChanges {
    std::uint64_t events = 0;     ///< in sum
    std::uint64_t different = 0;  ///< of those
    std::uint64_t very_late = 0;  ///< when others had had it for so long that it was not known any more
    std::uint64_t resets = 0, gaps = 0, left_out = 0;  ///< as of EventNumbers, in sum
    Times first;  ///< from a change to the first watcher that has its event
    Times last;   ///< to the last one
};

/// What many watchers receive of registries' events. An event is the same for all of them, and read once:
/// what a watcher costs is its place in the numbers of each registry. Pure.
class Changes {
  public:
    static constexpr std::size_t kMaxRegistries = 64;  ///< of more nothing is counted
    static constexpr std::size_t kMaxKept = 100'000;   ///< events that are known at a time
    static constexpr Duration kKept = std::chrono::seconds(60);

    /// When the change of an event happened, as this program did it; nothing: it did not, or not just so.
    using Happened = std::function<std::optional<Time>(const bus::ChangeEvent&)>;

    /// `kept`: so many events are known for kKept; of more, the oldest are not.
    Changes(std::size_t watchers, Happened happened, std::size_t kept = kMaxKept)
        : watchers_(watchers), happened_(std::move(happened)), max_kept_(kept) {}

    /// `watcher`, below the number of them, received an event. `now` does not decrease.
    void take(std::size_t watcher, std::string_view payload, Time now);
    /// Its connection was lost.
    void forget(std::size_t watcher);

    /// By the ids of registries.
    std::map<std::string, SeenChanges> seen() const;

  private:
    // Memory: for each registry a place for each watcher, and kMaxKept changes in all.
    struct Registry {
        std::string id;
        SeenChanges seen{};
        std::vector<EventNumbers> of_watchers;
        // The last that is not known any more.
        std::string old_epoch{};
        std::uint64_t old_seq = 0;
    };
    /// An event, from its first watcher until it is dropped.
    struct Change {
        std::size_t registry;
        std::string epoch;
        std::uint64_t seq;
        bool reset;
        std::optional<Time> happened;
        Time last;
    };
    struct Kept {
        std::size_t hash;
        Time since;
    };

    Change* known(std::string_view payload, Time now);
    std::optional<std::size_t> registry_of(const std::string& id);
    void drop_old(Time now);

    std::size_t watchers_;
    Happened happened_;
    std::size_t max_kept_;
    std::vector<Registry> registries_;
    std::unordered_map<std::size_t, Change> changes_;  // by the hash of their payloads
    std::deque<Kept> kept_;
};

}  // namespace asip::load
