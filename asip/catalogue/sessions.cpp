// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "asip/catalogue/catalogue_impl.hpp"

namespace asip::catalogue {
namespace {

// Sessions of our agents: ten hexadecimal digits of their start and six random ones, and what a session was
// given that had to become the later one. Those of other programs have no order.
bool has_time(std::string_view session) {
    constexpr std::size_t kDigits = 16;
    return session.size() >= kDigits && (session.size() == kDigits || session[kDigits] == '-') &&
           session.substr(0, kDigits).find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

bool is_older(std::string_view session, std::string_view than) {
    return has_time(session) && has_time(than) && session < than;
}

}  // namespace

Catalogue::Impl::Judgement Catalogue::Impl::judge(Board& b, const DescriptionMembers& members,
                                                  const Announcement& a, Time now, Events& events) {
    if (!b.described || b.session.empty()) return {Verdict::kAccept};
    if (b.session != members.session) return judge_other_session(b, members, a, now, events);
    if (members.seq < b.seq) return {Verdict::kRefuse, Refusal::kOldSequence};
    if (members.seq == b.seq) return {Verdict::kRenew};
    if (!a.retained) holder_spoke(b, now, events);
    return {Verdict::kAccept};
}

// A later session counts, whatever was before. An earlier one counts by what it says after the lease of the
// later one: the clock of its agent went back, and nothing on the bus told it of the later one.
Catalogue::Impl::Judgement Catalogue::Impl::judge_other_session(Board& b, const DescriptionMembers& members,
                                                                const Announcement& a, Time now,
                                                                Events& events) {
    const bool old = b.uncommon && b.uncommon->old_seq(members.session) != nullptr;
    if (old && members.seq <= *b.uncommon->old_seq(members.session))
        return {Verdict::kRefuse, Refusal::kOldSession};
    const bool later = is_older(b.session, members.session);
    const bool earlier = is_older(members.session, b.session);
    const bool too_early =
        earlier && !(published(a, lease_of(members), now) >= std::optional(b.session_ends));
    // It comes too early for ever, however late a bridge delivers it again.
    if (too_early) b.uncommon_data().remember(members.session, members.seq);
    if (!later && (too_early || !earlier)) {
        const bool holder_lives = alive(b, now) && b.proven;
        if (a.retained) {
            if (earlier || old) return {Verdict::kRefuse, Refusal::kOldSession};
            if (holder_lives) return {Verdict::kRefuse, Refusal::kUnproven};
        } else if (holder_lives) {
            const bool disputed = b.conflict() != nullptr && now < b.uncommon->challenger->deadline;
            if ((earlier || old || disputed) && !challenge(b, members, now, events))
                return {Verdict::kRefuse, Refusal::kConflict};
        } else if (earlier) {
            return {Verdict::kRefuse, Refusal::kOldSession};
        }
    }
    if (b.session != members.session) take_over(b, members);
    return {Verdict::kAccept};
}

std::optional<Time> Catalogue::Impl::published(const Announcement& a, std::uint32_t lease_seconds, Time now) {
    if (!a.expiry_seconds) return a.retained ? std::nullopt : std::optional(now);
    const Duration left = std::chrono::seconds(*a.expiry_seconds);
    return now - std::max<Duration>(std::chrono::seconds(lease_seconds) - left, Duration{});
}

// Another session lives beside the holder, or lived when its message was sent. One message may have been
// under way when the board changed hands; only one that comes after the holder has answered proves that both
// live. Then the larger session holds the board, whichever came first, so that every registry ends with the
// same one.
bool Catalogue::Impl::challenge(Board& b, const DescriptionMembers& members, Time now, Events& events) {
    UncommonBoardData& uncommon = b.uncommon_data();
    const auto lease = std::chrono::seconds(lease_of(members));
    if (auto* seq = uncommon.old_seq(members.session)) *seq = members.seq;
    if (!uncommon.challenger) uncommon.challenger = std::make_unique<Challenger>();
    Challenger& other = *uncommon.challenger;
    if (other.session != members.session) {
        const bool known = other.confirmed;
        other = Challenger{};
        other.session = members.session;
        other.answered = known;
        other.confirmed = known;
    }
    const bool new_conflict = other.answered && !other.confirmed;
    other.confirmed = other.confirmed || other.answered;
    other.seq = members.seq;
    other.deadline = now + lease;
    other.agent = members.agent;
    if (new_conflict) ++stats_.conflicts;
    const bool changes_hands = other.confirmed && b.session < members.session;
    if (changes_hands) take_over(b, members);
    if (new_conflict || changes_hands) emit(events, Event::Kind::kConflict, b);
    return changes_hands;
}

void Catalogue::Impl::holder_spoke(Board& b, Time now, Events& events) {
    if (!b.uncommon || !b.uncommon->challenger) return;
    if (now >= b.uncommon->challenger->deadline) {
        resolve(b, events);
    } else {
        b.uncommon->challenger->answered = true;
    }
}

void Catalogue::Impl::resolve(Board& b, Events& events) {
    const bool was_confirmed = b.uncommon->challenger->confirmed;
    b.uncommon->challenger.reset();
    if (!was_confirmed) return;
    --stats_.conflicts;
    emit(events, Event::Kind::kResolved, b);
}

// The session of `members` becomes the holder. The old one is remembered, so that its old messages cannot
// come back.
void Catalogue::Impl::take_over(Board& b, const DescriptionMembers& members) {
    UncommonBoardData& uncommon = b.uncommon_data();
    std::erase_if(uncommon.old_sessions, [&](const auto& entry) { return entry.first == members.session; });
    uncommon.remember(b.session, b.seq);
    if (uncommon.challenger && uncommon.challenger->session == members.session) {
        if (uncommon.challenger->confirmed) {
            Challenger& other = *uncommon.challenger;
            other.session = b.session;
            other.seq = b.seq;
            other.deadline = b.deadline;
            other.agent = b.agent();
        } else {
            uncommon.challenger.reset();
        }
    }
    b.session = members.session;
    b.seq = 0;
    b.deadline = b.session_ends = Time{};  // those of the session that is over
    b.proven = false;
    b.epoch_heard = 0;
}

}  // namespace asip::catalogue
