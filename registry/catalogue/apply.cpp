// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "asip/model/description.hpp"
#include "asip/model/names.hpp"
#include "registry/catalogue/catalogue_impl.hpp"

namespace asip::registry {
namespace {

using model::BoardState;

// Micro-controllers end what they publish as they end lines.
std::string_view without_line_end(std::string_view text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r' || text.back() == ' '))
        text.remove_suffix(1);
    return text;
}

bool valid_session(std::string_view text) {
    return !text.empty() && text.size() <= 64;
}

std::uint32_t lease_of(const DescriptionMembers& members, Duration fallback) {
    if (members.lease == 0) {
        return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::seconds>(fallback).count());
    }
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(members.lease, model::kMaxLeaseSeconds));
}

}  // namespace

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
    if (!read_description(a.payload, guesses_for(known), members) || !valid_session(members.session)) {
        return Refusal::kMalformed;
    }
    if (members.board != a.board) return Refusal::kWrongBoard;
    const bool same_labels = known != nullptr && known->described && known->extra() == members.extra;
    if (!same_labels && read_labels(members.labels, members.names) == nullptr) return Refusal::kMalformed;
    FirmwarePart* firmware = nullptr;
    PinsPart* pins = nullptr;
    ServicesPart* services = nullptr;
    if (!resolve_parts(members, known, firmware, pins, services)) return Refusal::kMalformed;

    const bool added = known == nullptr;
    if (added) {
        slot = make(a.board, now);
        if (slot == NameTable::kNone) {
            drop_unused(firmware, pins, services);
            return Refusal::kTooMany;
        }
    }
    Board& b = board(slot);
    const bool new_session = b.session != members.session || !b.described;
    const bool live = !a.retained;
    const Judgement judgement = judge(b, members, live, now, events);
    const bool renews = judgement.verdict == Verdict::kRenew;
    if (judgement.verdict == Verdict::kRefuse) {
        drop_unused(firmware, pins, services);
        return judgement.refusal;
    }
    bool changed = false;
    if (renews) {
        drop_unused(firmware, pins, services);
    } else {
        changed = store(slot, members, firmware, pins, services);
        b.session = members.session;
        b.seq = members.seq;
        b.lease_seconds = lease_of(members, options_.default_lease);
    }

    const auto lease = std::chrono::seconds(b.lease_seconds);
    if (live) {
        // "offline" is older than a description with a new number, but not than a repetition of the last one.
        if (!renews && !is_alive_word(b.reported)) b.reported = BoardState::kOnline;
        if (is_alive_word(b.reported)) b.deadline = now + lease;
        b.proven = true;
        b.retained_without_expiry = !a.expiry_seconds;
        b.names_only = false;
        listen(b, false, events);
        heard(b, now);
    } else if (is_alive_word(b.reported)) {
        b.retained_without_expiry = !a.expiry_seconds;
        if (a.expiry_seconds) {
            b.deadline = std::max(b.deadline,
                                  now + std::min<Duration>(std::chrono::seconds(*a.expiry_seconds), lease));
        } else if (!renews) {
            b.deadline = std::max(b.deadline, now + lease);
        }
    }
    if (live && !added && !changed && !renews) ++stats_.renewals;
    update_state(slot, now, live ? Event::Reason::kAnnounced : Event::Reason::kRetained, events, added);
    if (added) {
        emit(events, Event::Kind::kAdded, b, live ? Event::Reason::kAnnounced : Event::Reason::kRetained);
    } else if (changed || (new_session && !renews)) {
        emit(events, Event::Kind::kDescription, b);
    }
    return std::nullopt;
}

std::optional<Refusal> Catalogue::Impl::state(const Announcement& a, Time now, Events& events) {
    if (!model::valid_board_name(a.board)) return Refusal::kBadName;
    std::uint32_t slot = slot_of(a.board);
    const bool added = slot == NameTable::kNone;
    if (a.payload.empty()) {
        // Another program forgot this board: so does the catalogue, unless the board is known to be alive.
        if (!added && !is_alive_word(board(slot).effective)) release(slot, events);
        return std::nullopt;
    }
    const auto reported = model::board_state_from_text(a.payload);
    if (!reported) return Refusal::kBadState;
    if (added) {
        slot = make(a.board, now);
        if (slot == NameTable::kNone) return Refusal::kTooMany;
    }
    Board& b = board(slot);
    const bool live = !a.retained;
    if (!live && !added && b.epoch_heard == epoch_) return Refusal::kOldHint;
    b.reported = *reported;
    if (live && is_alive_word(*reported)) {
        b.deadline = now + std::chrono::seconds(b.lease_seconds);
        heard(b, now);
    } else if (live) {
        b.deadline = now;
        b.epoch_heard = epoch_;
    }
    auto reason = Event::Reason::kRetained;
    if (live) reason = *reported == BoardState::kLost ? Event::Reason::kWill : Event::Reason::kReported;
    update_state(slot, now, reason, events, added);
    if (added) emit(events, Event::Kind::kAdded, b, reason);
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
    if (added) {
        emit(events, Event::Kind::kAdded, board(slot),
             a.retained ? Event::Reason::kRetained : Event::Reason::kAnnounced);
    }
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
        emit(events, Event::Kind::kAdded, b,
             a.retained ? Event::Reason::kRetained : Event::Reason::kAnnounced);
    } else if (changed) {
        emit(events, Event::Kind::kDescription, b);
    }
    return refused;
}

// A name renews the lease of its board, unless a description does that already: it has its own lease.
std::optional<Refusal> Catalogue::Impl::renewed_by_names(std::uint32_t slot, bool retained, bool added,
                                                         Time now, Events& events) {
    Board& b = board(slot);
    if (retained) {
        update_state(slot, now, Event::Reason::kRetained, events, added);
        return std::nullopt;
    }
    if (b.described && alive(b, now)) return std::nullopt;
    b.names_only = true;
    listen(b, true, events);
    if (!is_alive_word(b.reported)) b.reported = BoardState::kOnline;
    if (!b.described) {
        b.lease_seconds = static_cast<std::uint32_t>(
            std::chrono::duration_cast<std::chrono::seconds>(options_.default_lease).count());
    }
    b.deadline = now + std::chrono::seconds(b.lease_seconds);
    heard(b, now);
    update_state(slot, now, Event::Reason::kAnnounced, events, added);
    return std::nullopt;
}

std::optional<Refusal> Catalogue::Impl::traffic(const Announcement& a, Time now, Events& events) {
    if (a.retained) return Refusal::kNotForUs;
    const std::uint32_t slot = slot_of(a.board);
    if (slot == NameTable::kNone || !board(slot).names_only) return Refusal::kNotForUs;
    return renewed_by_names(slot, false, false, now, events);
}

std::vector<Event> Catalogue::Impl::expire(Time now) {
    Events events;
    if (suspended_) return events;
    for (due_.clear(), wheel_.advance(now, due_); !due_.empty(); due_.clear(), wheel_.advance(now, due_)) {
        for (const std::uint32_t slot : due_) {
            Board& b = board(slot);
            if (!is_alive_word(b.effective)) {
                const Time due = forgotten_at(b, now);
                due > now ? wheel_.set(slot, due, now) : release(slot, events);
                continue;
            }
            ++stats_.expired;
            update_state(slot, now, Event::Reason::kLease, events);
            if (b.retained_without_expiry && b.described) emit(events, Event::Kind::kGhost, b);
        }
    }
    return events;
}

void Catalogue::Impl::resume(Time now) {
    suspended_ = false;
    ++epoch_;
    for (std::uint32_t slot = 0; slot < slots_; ++slot) {
        Board& b = board(slot);
        if (!b.in_use) continue;
        const Duration grace = std::min<Duration>(options_.grace, std::chrono::seconds(b.lease_seconds));
        if (is_alive_word(b.effective)) b.deadline = std::max(b.deadline, now + grace);
        const Time due = is_alive_word(b.effective) ? b.deadline : now + options_.grace;
        if (const auto set = wheel_.due(slot); !set || *set < due) wheel_.set(slot, due, now);
    }
}

Expected<std::vector<Event>, Catalogue::NotForgotten> Catalogue::Impl::forget(std::string_view name,
                                                                              Time now) {
    const std::uint32_t slot = slot_of(name);
    if (slot == NameTable::kNone) return Unexpected<NotForgotten>(NotForgotten::kUnknown);
    if (alive(board(slot), now) || is_alive_word(board(slot).effective)) {
        return Unexpected<NotForgotten>(NotForgotten::kAlive);
    }
    Events events;
    release(slot, events);
    return events;
}

}  // namespace asip::registry
