// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "asip/catalogue/catalogue_impl.hpp"
#include "asip/model/description.hpp"
#include "asip/model/names.hpp"

namespace asip::catalogue {
namespace {

using model::BoardState;

// Ages of stored messages are whole seconds, and messages take a while: what is less apart may be one moment.
constexpr Duration kApart = std::chrono::seconds(2);

bool valid_session(std::string_view text) {
    return !text.empty() && text.size() <= 64;
}

}  // namespace

std::string_view without_line_end(std::string_view text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r' || text.back() == ' '))
        text.remove_suffix(1);
    return text;
}

Applied Catalogue::Impl::apply(const Announcement& a, Time now) {
    using bus::TopicKind;
    Applied applied;
    ++stats_.applied;
    switch (a.kind) {
        case TopicKind::kDescription:
            applied.refused = description(a, now, applied.events);
            break;
        case TopicKind::kState:
            applied.refused = state(a, now, applied.events);
            break;
        case TopicKind::kBoardNames:
            applied.refused = board_name(a, now, applied.events);
            break;
        case TopicKind::kServiceNames:
            applied.refused = service_name(a, now, applied.events);
            break;
        case TopicKind::kBoardOut:
        case TopicKind::kServiceOut:
            applied.refused = traffic(a, now, applied.events);
            break;
        default:
            applied.refused = Refusal::kNotForUs;
            break;
    }
    if (applied.refused) ++stats_.refused[static_cast<std::size_t>(*applied.refused)];
    return applied;
}

std::optional<Refusal> Catalogue::Impl::description(const Announcement& a, Time now, Events& events) {
    if (a.payload.empty()) return std::nullopt;  // emptied by a program that tidies up; what is known stays
    if (!model::valid_board_name(a.board)) return Refusal::kBadName;
    if (a.payload.size() > model::kMaxDescriptionBytes) return Refusal::kTooLong;
    std::uint32_t slot = slot_of(a.board);
    Board* known = slot == NameTable::kNone ? nullptr : &board(slot);

    DescriptionMembers members;
    if (!read_description(a.payload, guesses_for(known), members) || !valid_session(members.session))
        return Refusal::kMalformed;
    if (members.board != a.board) return Refusal::kWrongBoard;
    const bool same_labels = known != nullptr && known->described && known->extra() == members.extra;
    if (!same_labels && read_labels(members.labels, members.names) == nullptr) return Refusal::kMalformed;
    FirmwarePart* firmware = nullptr;
    PinsPart* pins = nullptr;
    ServicesPart* services = nullptr;
    if (!resolve_parts(members, known, firmware, pins, services)) return Refusal::kMalformed;

    const bool added = known == nullptr;
    if (added) slot = make(a.board, now);
    if (slot == NameTable::kNone) {
        drop_unused(firmware, pins, services);
        return Refusal::kTooMany;
    }
    Board& b = board(slot);
    const bool new_session = b.session != members.session || !b.described;
    const bool succeeds = b.described && new_session;
    const bool live = !a.retained;
    const Judgement judgement = judge(b, members, a, now, events);
    const bool renews = judgement.verdict == Verdict::kRenew;
    if (judgement.verdict == Verdict::kRefuse) {
        drop_unused(firmware, pins, services);
        return judgement.refusal;
    }
    bool changed = false;
    if (renews) {
        drop_unused(firmware, pins, services);
    } else {
        // Its description tells the lease: that of a word or of a name ahead of it was a guess.
        if (!b.described) b.deadline = b.session_ends = Time{};
        changed = store(slot, members, firmware, pins, services);
        b.session = members.session;
        b.seq = members.seq;
        b.lease_seconds = lease_of(members);
        b.says_state = members.state.has_value();
    }

    if (!renews && members.state) {
        take_said_state(b, members, a, new_session, now);
    } else if (!renews && live && succeeds && !model::is_there(b.reported)) {
        say(b, {}, now, now);
    }
    renewed_by_description(b, a, renews, now, events);
    if (live && !added && !changed && !renews) ++stats_.renewals;
    update_state(slot, now, events, added);
    if (added) {
        emit(events, Event::Kind::kAdded, b);
    } else if (changed || (new_session && !renews)) {
        emit(events, Event::Kind::kDescription, b);
    }
    return std::nullopt;
}

// The state that a description holds. An agent publishes it before the same on `$state`: so a retained
// `$state` that says something else of a board that was there is newer, and the word of the broker, unless
// the description is the younger one. The board was there behind what was known of it, and is gone anew.
void Catalogue::Impl::take_said_state(Board& b, const DescriptionMembers& members, const Announcement& a,
                                      bool new_session, Time now) {
    const Time said_at = published(a, b.lease_seconds, now).value_or(now);
    const bool younger = a.expiry_seconds && b.said_at != Time{} && said_at > b.said_at + kApart;
    const bool word = a.retained && b.epoch_gone == epoch_ && !model::is_there(b.reported) &&
                      members.state->state != b.reported;
    if (word && !younger) {
        b.reported_since = Time{};
        return say(b, {b.reported, model::reason_of_word(b.reported)}, b.said_at, now);
    }
    b.said_at = said_at;
    const auto age = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(members.state->age));
    // Another session came into its state when it says, though the one before it had been in the same.
    if (new_session) b.reported_since = Time{};
    say(b, *members.state, said_at - age, now);
}

// Messages that say the same again can only be later than the moment, so the earliest counts, unless the
// board left the state meanwhile and came into it again.
void Catalogue::Impl::say(Board& b, const model::SaidState& said, Time since, Time now) {
    const bool same =
        b.reported == said.state && b.reported_reason == said.reason && b.reported_since != Time{};
    if (same && since == Time{}) since = b.reported_since;
    if (same && since > b.reported_since - kApart && since < b.reported_since + kApart)
        since = std::min(since, b.reported_since);
    b.reported = said.state;
    b.state_said = true;
    b.reported_reason = said.reason;
    b.reported_since = std::min(since, now);
}

std::optional<Refusal> Catalogue::Impl::state(const Announcement& a, Time now, Events& events) {
    if (!model::valid_board_name(a.board)) return Refusal::kBadName;
    std::uint32_t slot = slot_of(a.board);
    const bool added = slot == NameTable::kNone;
    if (a.payload.empty()) {
        // Another program forgot this board: so does the catalogue, unless the board is known to be alive.
        if (!added && !model::is_there(board(slot).effective)) release(slot, events);
        return std::nullopt;
    }
    const auto reported = model::board_state_from_text(without_line_end(a.payload));
    if (!reported) return Refusal::kBadState;
    if (added) {
        slot = make(a.board, now);
        if (slot == NameTable::kNone) return Refusal::kTooMany;
    }
    Board& b = board(slot);
    const bool live = !a.retained;
    if (!live && !added && b.epoch_heard == epoch_) return Refusal::kOldHint;
    const bool there = model::is_there(*reported);
    std::optional<Time> published;
    if (a.expiry_seconds && *a.expiry_seconds <= model::kStateExpirySeconds)
        published = now - std::chrono::seconds(model::kStateExpirySeconds - *a.expiry_seconds);
    // A bridge delivers what it has stored again: the agent has said more since then.
    if (b.says_state && !there && published && *published + kApart < b.said_at) return Refusal::kOldHint;
    // The newer of two words counts, also where both say that it is not there: a will comes after a stop,
    // too, and the description that came with a stop may have come and gone while nothing was heard.
    const bool gone_otherwise =
        !there && !model::is_there(b.reported) && *reported != b.reported && (live || published);
    // It was there again behind all that is known of it.
    const bool was_back = there && !live && published && !model::is_there(b.effective) &&
                          *published > std::max(b.said_at, b.since);
    const bool again = !live && published && *published <= b.said_at + kApart && *reported == b.reported;
    if ((!b.says_state && !again) || (!there && model::is_there(b.reported)) || gone_otherwise || was_back) {
        Time since = live && (added || *reported != b.reported) ? now : Time{};
        if (!live && published) since = *published;
        say(b, {*reported, model::reason_of_word(*reported)}, since, now);
    }
    const auto lease = std::chrono::seconds(b.lease_seconds);
    if (there && published && b.described && !b.says_state)
        b.deadline = std::max(b.deadline, *published + lease);
    // No description told a lease: behind an interruption the board has to be heard again.
    if (!live && !b.described) b.deadline = std::min(b.deadline, now + options_.grace);
    // The broker has forgotten the description that said so: when the lease ended is not known.
    if (was_back && (b.says_state || !b.described || b.deadline <= now)) b.deadline = b.since = Time{};
    if (!there && b.reported == *reported) b.epoch_gone = epoch_;
    // Beside descriptions that hold the state, a word that the board is there says nothing: the description
    // that came with it may never be heard.
    if (!there || !b.says_state) b.said_at = std::max(b.said_at, published.value_or(live ? now : Time{}));
    if (live && !b.says_state && there) {
        b.deadline = now + lease;
        b.last_heard = now;
    }
    if (live) b.epoch_heard = epoch_;
    update_state(slot, now, events, added);
    if (added) emit(events, Event::Kind::kAdded, b);
    return std::nullopt;
}

std::optional<Refusal> Catalogue::Impl::board_name(const Announcement& a, Time now, Events& events) {
    const std::string_view name = without_line_end(a.payload);
    if (name.empty() && a.retained) return std::nullopt;
    if (!model::valid_board_name(name)) return Refusal::kBadName;
    std::uint32_t slot = slot_of(name);
    const bool added = slot == NameTable::kNone;
    if (added) slot = make(name, now);
    if (slot == NameTable::kNone) return Refusal::kTooMany;
    const auto refused = renewed_by_names(slot, a.retained, added, now, events);
    if (added) emit(events, Event::Kind::kAdded, board(slot));
    return refused;
}

std::optional<Refusal> Catalogue::Impl::service_name(const Announcement& a, Time now, Events& events) {
    if (a.payload.empty()) return std::nullopt;
    const std::string_view name = without_line_end(a.payload);
    if (!model::valid_board_name(a.board) || !model::valid_name(name)) return Refusal::kBadName;
    std::uint32_t slot = slot_of(a.board);
    const bool added = slot == NameTable::kNone;
    if (added) slot = make(a.board, now);
    if (slot == NameTable::kNone) return Refusal::kTooMany;
    Board& b = board(slot);
    bool changed = false;
    if (!b.described) {
        auto& named = b.uncommon_data().service_names;
        const auto place = std::lower_bound(named.begin(), named.end(), name);
        if (place == named.end() || *place != name) {
            if (named.size() == model::kMaxDescriptionServices) return Refusal::kTooMany;
            named.emplace(place, name);
            set_named_services(slot);
            changed = true;
        }
    }
    const auto refused = renewed_by_names(slot, a.retained, added, now, events);
    if (added) {
        emit(events, Event::Kind::kAdded, b);
    } else if (changed) {
        emit(events, Event::Kind::kDescription, b);
    }
    return refused;
}

std::optional<Refusal> Catalogue::Impl::traffic(const Announcement& a, Time now, Events& events) {
    if (a.retained) return Refusal::kNotForUs;
    const std::uint32_t slot = slot_of(a.board);
    if (slot == NameTable::kNone || !board(slot).names_only) return Refusal::kNotForUs;
    return renewed_by_names(slot, false, false, now, events);
}

Expected<std::vector<Event>, Catalogue::NotForgotten> Catalogue::Impl::forget(std::string_view name,
                                                                              Time now) {
    const std::uint32_t slot = slot_of(name);
    if (slot == NameTable::kNone) return Unexpected<NotForgotten>(NotForgotten::kUnknown);
    if (alive(board(slot), now) || model::is_there(board(slot).effective)) {
        return Unexpected<NotForgotten>(NotForgotten::kAlive);
    }
    Events events;
    release(slot, events);
    return events;
}

}  // namespace asip::catalogue
