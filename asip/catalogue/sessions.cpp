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

Catalogue::Impl::Judgement Catalogue::Impl::judge(Board& b, const DescriptionMembers& members, bool live,
                                                  Time now, Events& events) {
    if (!b.described || b.session.empty()) return {Verdict::kAccept};
    if (b.session != members.session) return judge_other_session(b, members, live, now, events);
    if (members.seq < b.seq) return {Verdict::kRefuse, Refusal::kOldSequence};
    if (members.seq == b.seq) return {Verdict::kRenew};
    if (live) holder_spoke(b, now, events);
    return {Verdict::kAccept};
}

Catalogue::Impl::Judgement Catalogue::Impl::judge_other_session(Board& b, const DescriptionMembers& members,
                                                                bool live, Time now, Events& events) {
    auto* old = static_cast<std::pair<std::string, std::uint64_t>*>(nullptr);
    if (b.uncommon) {
        for (auto& entry : b.uncommon->old_sessions) {
            if (entry.first == members.session) old = &entry;
        }
    }
    if (old != nullptr && members.seq <= old->second) return {Verdict::kRefuse, Refusal::kOldSession};
    const bool holder_lives = alive(b, now) && b.proven;
    const bool older = is_older(members.session, b.session);
    const bool newer = is_older(b.session, members.session);
    if (!live) {
        if (old != nullptr || older) return {Verdict::kRefuse, Refusal::kOldSession};
        if (holder_lives && !newer) return {Verdict::kRefuse, Refusal::kUnproven};
    } else if (holder_lives) {
        const bool disputed = b.conflict() != nullptr && now < b.uncommon->challenger->deadline;
        if (old != nullptr || disputed || older) {
            if (!challenge(b, members, now, events)) return {Verdict::kRefuse, Refusal::kConflict};
            return {Verdict::kAccept};
        }
    } else if (older && now < b.deadline) {
        // What its session said last counts. An agent whose clock went back makes its session a later one
        // where it sees this one, and nothing renews this one where it does not.
        return {Verdict::kRefuse, Refusal::kOldSession};
    }
    take_over(b, members, now);
    return {Verdict::kAccept};
}

// Another session lives beside the holder, or lived when its message was sent. One message may have been
// under way when the board changed hands; only one that comes after the holder has answered proves that both
// live. Then the larger session holds the board, whichever came first, so that every registry ends with the
// same one.
bool Catalogue::Impl::challenge(Board& b, const DescriptionMembers& members, Time now, Events& events) {
    UncommonBoardData& uncommon = b.uncommon_data();
    const auto lease = std::chrono::seconds(members.lease == 0 ? b.lease_seconds : members.lease);
    for (auto& entry : uncommon.old_sessions) {
        if (entry.first == members.session) entry.second = members.seq;
    }
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
    if (changes_hands) take_over(b, members, now);
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
void Catalogue::Impl::take_over(Board& b, const DescriptionMembers& members, Time) {
    UncommonBoardData& uncommon = b.uncommon_data();
    auto& old = uncommon.old_sessions;
    old.erase(std::remove_if(old.begin(), old.end(),
                             [&](const auto& entry) { return entry.first == members.session; }),
              old.end());
    old.emplace_back(b.session, b.seq);
    if (old.size() > kOldSessions) old.erase(old.begin());
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
    b.proven = false;
    b.epoch_heard = 0;
}

}  // namespace asip::catalogue
