// SPDX-License-Identifier: Apache-2.0
// How long a board counts as there: what renews its lease, and what is true when nothing does.
#include <algorithm>

#include "asip/catalogue/catalogue_impl.hpp"
#include "asip/model/description.hpp"

namespace asip::catalogue {
namespace {

constexpr Duration kAskedAgain = std::chrono::hours(24) + std::chrono::minutes(1);

// What the grace after an interruption added is no time in which the board was there. Names, and words beside
// descriptions without a state, open a lease, too.
Time lease_ended(const Board& b) {
    const auto lease = std::chrono::seconds(b.lease_seconds);
    const bool by_descriptions = b.says_state && !b.names_only;
    const Time renewed = by_descriptions ? Time{} : std::max(b.last_heard, b.said_at) + lease;
    return std::min(b.deadline, std::max(b.session_ends, renewed));
}

}  // namespace

std::uint32_t Catalogue::Impl::lease_of(const DescriptionMembers& members) const {
    if (members.lease != 0)
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(members.lease, model::kMaxLeaseSeconds));
    return static_cast<std::uint32_t>(
        std::chrono::duration_cast<std::chrono::seconds>(options_.default_lease).count());
}

// A live description proves its board. Each renews the lease from when it was published: a bridge may deliver
// one late, or again. `repeats`: it says nothing new.
void Catalogue::Impl::renewed_by_description(Board& b, const Announcement& a, bool repeats, Time now,
                                             Events& events) {
    const auto said_at = published(a, b.lease_seconds, now);
    if (said_at || !repeats) {
        const Time ends = said_at.value_or(now) + std::chrono::seconds(b.lease_seconds);
        const bool sets = !a.retained && !repeats;  // a lease that became shorter, too
        b.session_ends = sets ? ends : std::max(b.session_ends, ends);
        b.deadline = sets ? ends : std::max(b.deadline, b.session_ends);
    }
    if (!a.retained) {
        b.proven = true;
        b.retained_without_expiry = !a.expiry_seconds;
        b.names_only = false;
        listen(b, false, events);
        // One that does not speak of the state makes what is retained of it no older.
        b.last_heard = std::max(b.last_heard, *said_at);
        if (b.says_state) b.epoch_heard = epoch_;
    } else if (model::is_there(b.reported)) {
        b.retained_without_expiry = !a.expiry_seconds;
    }
}

// A name renews the lease of its board, unless a description does that already: it has its own lease. It does
// not take back what was said, nor what is retained and comes behind it: an agent whose board is away answers
// probes, too.
std::optional<Refusal> Catalogue::Impl::renewed_by_names(std::uint32_t slot, bool retained, bool added,
                                                         Time now, Events& events) {
    Board& b = board(slot);
    if (retained) {
        update_state(slot, now, events, added);
        return std::nullopt;
    }
    if (b.described && (alive(b, now) || !model::is_there(b.reported))) return std::nullopt;
    b.names_only = true;
    listen(b, true, events);
    if (!b.described) {
        b.lease_seconds = static_cast<std::uint32_t>(
            std::chrono::duration_cast<std::chrono::seconds>(options_.default_lease).count());
    }
    b.deadline = now + std::chrono::seconds(b.lease_seconds);
    b.last_heard = now;
    update_state(slot, now, events, added);
    return std::nullopt;
}

// Brings the effective state into line with what was reported and the lease, the indices with it, and the
// wheel with both.
void Catalogue::Impl::update_state(std::uint32_t slot, Time now, Events& events, bool added) {
    Board& b = board(slot);
    const bool living = alive(b, now);
    const model::BoardState was = b.effective;
    const model::BoardState is =
        living || !model::is_there(b.reported) ? b.reported : model::BoardState::kLost;
    const bool judged = is != b.reported;  // by its lease
    const auto reason = judged ? model::StateReason::kExpired : b.reported_reason;
    if (is != was) {
        index(b, slot, false);
        all_[index_of(was)].remove(slot);
        b.effective = is;
        all_[index_of(is)].add(slot);
        index(b, slot, true);
    }
    if (is != was || added) {
        const bool no_lease = added || b.deadline == Time{};
        const bool unknown = judged ? no_lease : !model::is_there(is) && b.reported_since == Time{};
        b.since = unknown ? Time{} : judged ? lease_ended(b) : now;
    }
    const bool told = b.says_state || !model::is_there(is);
    if (!judged && told && b.reported_since != Time{}) b.since = b.reported_since;
    const bool other_reason = reason != b.reason;
    b.reason = reason;
    if ((is != was || other_reason) && !added) emit(events, Event::Kind::kState, b, was);
    if (is != was && !living && b.conflict() != nullptr) resolve(b, events);
    Time due = living ? b.deadline : forgotten_at(b, now);
    // A board that was remembered may be long due: what the broker retains of it is heard first.
    if (!living && options_.remembered) due = std::max(due, now + options_.grace);
    wheel_.set(slot, due, now);
}

// The answer about a remembered board may change with what becomes known of the clocks, so it is asked
// for again at the latest a day later.
Time Catalogue::Impl::forgotten_at(Board& b, Time now) const {
    const bool told = b.says_state && b.since != Time{} && b.since == b.reported_since;
    const bool no_lease = b.deadline == Time{};  // it was there behind all that was remembered
    if (const auto known = remembered(b.name); known && known->state == b.effective && !told && !no_lease)
        b.since = b.since == Time{} ? now - known->age : std::min(b.since, now - known->age);
    const Time gone = b.since == Time{} ? b.first_seen : b.since;
    const Time due = std::max(gone, b.last_heard) + options_.forget_after;
    return options_.remembered ? std::min(due, now + kAskedAgain) : due;
}

std::vector<Event> Catalogue::Impl::expire(Time now, std::size_t most) {
    Events events;
    if (suspended_) return events;
    for (due_.clear(), wheel_.advance(now, due_); !due_.empty(); due_.clear(), wheel_.advance(now, due_)) {
        const auto judged = std::min(most, due_.size());
        for (std::size_t i = 0; i < judged; ++i)
            judge(due_[i], now, events);
        most -= judged;
        for (std::size_t i = judged; i < due_.size(); ++i)
            wheel_.set(due_[i], now, now);
        if (most == 0) break;
    }
    return events;
}

void Catalogue::Impl::judge(std::uint32_t slot, Time now, Events& events) {
    Board& b = board(slot);
    if (!model::is_there(b.effective)) {
        const Time due = forgotten_at(b, now);
        due > now ? wheel_.set(slot, due, now) : release(slot, events);
        return;
    }
    ++stats_.expired;
    update_state(slot, now, events);
    if (b.retained_without_expiry && b.described) emit(events, Event::Kind::kGhost, b);
}

void Catalogue::Impl::resume(Time now) {
    suspended_ = false;
    ++epoch_;
    for (std::uint32_t slot = 0; slot < slots_; ++slot) {
        Board& b = board(slot);
        if (!b.in_use) continue;
        const auto set = wheel_.due(slot);
        if (!model::is_there(b.effective)) {
            if (!set || *set < now + options_.grace) wheel_.set(slot, now + options_.grace, now);
            continue;
        }
        const Duration grace = std::min<Duration>(options_.grace, std::chrono::seconds(b.lease_seconds));
        b.deadline = std::max(b.deadline, now + grace);
        if (set != b.deadline) wheel_.set(slot, b.deadline, now);
    }
}

}  // namespace asip::catalogue
