#include <algorithm>

#include "registry/catalogue/catalogue_impl.hpp"

namespace asip::registry {

Catalogue::Impl::Judgement Catalogue::Impl::judge(Board& b, const Scan& scan, bool live, Time now,
                                                  Events& events) {
    if (!b.described || b.session.empty()) return {Verdict::kAccept};
    if (b.session != scan.session) return judge_other_session(b, scan, live, now, events);
    if (scan.seq < b.seq) return {Verdict::kRefuse, Refusal::kOldSequence};
    if (scan.seq == b.seq) return {Verdict::kRenew};
    if (live) holder_spoke(b, now, events);
    return {Verdict::kAccept};
}

Catalogue::Impl::Judgement Catalogue::Impl::judge_other_session(Board& b, const Scan& scan, bool live,
                                                                Time now, Events& events) {
    auto* old = static_cast<std::pair<std::string, std::uint64_t>*>(nullptr);
    if (b.rare) {
        for (auto& entry : b.rare->old_sessions) {
            if (entry.first == scan.session) old = &entry;
        }
    }
    if (old != nullptr && scan.seq <= old->second) return {Verdict::kRefuse, Refusal::kOldSession};
    const bool holder_lives = alive(b, now) && b.proven;
    if (!live) {
        if (old != nullptr) return {Verdict::kRefuse, Refusal::kOldSession};
        if (holder_lives) return {Verdict::kRefuse, Refusal::kUnproven};
    } else if (holder_lives) {
        const bool disputed = b.conflict() != nullptr && now < b.rare->challenger->deadline;
        if (old != nullptr || disputed) {
            if (!challenge(b, scan, now, events)) return {Verdict::kRefuse, Refusal::kConflict};
            return {Verdict::kAccept};
        }
    }
    take_over(b, scan, now);
    return {Verdict::kAccept};
}

// Another session lives beside the holder, or lived when its message was sent. One message may have been
// under way when the board changed hands; only one that comes after the holder has answered proves that both
// live. Then the larger session holds the board, whichever came first, so that every registry ends with the
// same one.
bool Catalogue::Impl::challenge(Board& b, const Scan& scan, Time now, Events& events) {
    Rare& rare = b.rarely();
    const auto lease = std::chrono::seconds(scan.lease == 0 ? b.lease_seconds : scan.lease);
    for (auto& entry : rare.old_sessions) {
        if (entry.first == scan.session) entry.second = scan.seq;
    }
    if (!rare.challenger) rare.challenger = std::make_unique<Challenger>();
    Challenger& other = *rare.challenger;
    if (other.session != scan.session) {
        const bool known = other.confirmed;
        other = Challenger{};
        other.session = scan.session;
        other.answered = known;
        other.confirmed = known;
    }
    const bool new_conflict = other.answered && !other.confirmed;
    other.confirmed = other.confirmed || other.answered;
    other.seq = scan.seq;
    other.deadline = now + lease;
    other.agent = scan.agent;
    if (new_conflict) ++stats_.conflicts;
    const bool changes_hands = other.confirmed && b.session < scan.session;
    if (changes_hands) take_over(b, scan, now);
    if (new_conflict || changes_hands) emit(events, Event::Kind::kConflict, b);
    return changes_hands;
}

void Catalogue::Impl::holder_spoke(Board& b, Time now, Events& events) {
    if (!b.rare || !b.rare->challenger) return;
    if (now >= b.rare->challenger->deadline) {
        resolve(b, events);
    } else {
        b.rare->challenger->answered = true;
    }
}

void Catalogue::Impl::resolve(Board& b, Events& events) {
    const bool was_confirmed = b.rare->challenger->confirmed;
    b.rare->challenger.reset();
    if (!was_confirmed) return;
    --stats_.conflicts;
    emit(events, Event::Kind::kResolved, b);
}

// The session of `scan` becomes the holder; the old one is remembered, so that what it said before cannot
// come back.
void Catalogue::Impl::take_over(Board& b, const Scan& scan, Time) {
    Rare& rare = b.rarely();
    auto& old = rare.old_sessions;
    old.erase(std::remove_if(old.begin(), old.end(),
                             [&](const auto& entry) { return entry.first == scan.session; }),
              old.end());
    old.emplace_back(b.session, b.seq);
    if (old.size() > kOldSessions) old.erase(old.begin());
    if (rare.challenger && rare.challenger->session == scan.session) {
        if (rare.challenger->confirmed) {
            Challenger& other = *rare.challenger;
            other.session = b.session;
            other.seq = b.seq;
            other.deadline = b.deadline;
            other.agent = b.agent();
        } else {
            rare.challenger.reset();
        }
    }
    b.session = scan.session;
    b.seq = 0;
    b.proven = false;
}

}  // namespace asip::registry
