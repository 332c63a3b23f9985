// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/catalogue/description_parts.hpp"
#include "asip/model/board_state.hpp"
#include "asip/model/labels.hpp"
#include "asip/time.hpp"

namespace asip::catalogue {

/// A session that claims a board beside its holder.
struct Challenger {
    std::string session;
    std::uint64_t seq = 0;
    Time deadline{};         // of its lease
    std::string agent;       // JSON text
    bool answered = false;   // the holder announced itself after it
    bool confirmed = false;  // and it announced itself again: both live
};

/// Apart, because few boards have it.
struct UncommonBoardData {
    static constexpr std::size_t kOldSessions = 8;
    // the newest last, with the highest seq seen
    std::vector<std::pair<std::string, std::uint64_t>> old_sessions;
    std::vector<std::string> service_names;  // published names, sorted
    std::unique_ptr<Challenger> challenger;
    std::unique_ptr<model::Labels> labels;  // null: none

    std::uint64_t* old_seq(std::string_view session) {
        for (auto& [old, seq] : old_sessions)
            if (old == session) return &seq;
        return nullptr;
    }
    void remember(std::string_view session, std::uint64_t seq) {
        if (auto* known = old_seq(session)) {
            *known = std::max(*known, seq);
            return;
        }
        old_sessions.emplace_back(session, seq);
        if (old_sessions.size() > kOldSessions) old_sessions.erase(old_sessions.begin());
    }
};

struct Board {
    std::string name;
    std::string session;
    std::string own;  // not shared with other boards: agent, link and unknown members, one after another
    std::uint32_t agent_bytes = 0;
    std::uint32_t link_bytes = 0;
    std::uint32_t epoch_heard = 0;  // of the connection over which its state was last heard
    std::uint32_t epoch_gone = 0;   // of the one over which `$state` last said that it is not there
    std::uint32_t lease_seconds = 0;
    FirmwarePart* firmware = nullptr;
    PinsPart* pins = nullptr;
    ServicesPart* services = nullptr;
    std::uint64_t seq = 0;
    Time deadline{};      // of its lease
    Time session_ends{};  // the same of its descriptions alone, and without grace
    Time last_heard{};
    Time first_seen{};
    Time since{};           // of `effective`; Time{}: not known
    Time reported_since{};  // the same of `reported`
    Time said_at{};         // when its state was said last, as far as can be known
    std::unique_ptr<UncommonBoardData> uncommon;
    model::BoardState reported = model::BoardState::kOnline;
    model::BoardState effective = model::BoardState::kLost;
    model::StateReason reported_reason = model::StateReason::kNone;
    model::StateReason reason = model::StateReason::kNone;  // of `effective`
    bool in_use = false;
    bool described = false;
    bool names_only = false;  // its lease is renewed by names and traffic, not by descriptions
    bool listening = false;
    bool state_said = false;               // `reported` was said, in whichever way
    bool says_state = false;               // its descriptions hold the state: they alone make it be there
    bool proven = false;                   // its session was heard live, not only retained
    bool retained_without_expiry = false;  // its description, as far as can be known

    std::string_view agent() const { return std::string_view(own).substr(0, agent_bytes); }
    std::string_view link() const { return std::string_view(own).substr(agent_bytes, link_bytes); }
    std::string_view extra() const { return std::string_view(own).substr(agent_bytes + link_bytes); }
    UncommonBoardData& uncommon_data() {
        if (!uncommon) uncommon = std::make_unique<UncommonBoardData>();
        return *uncommon;
    }
    const model::Labels* labels() const { return uncommon ? uncommon->labels.get() : nullptr; }
    const Challenger* conflict() const {
        return uncommon && uncommon->challenger && uncommon->challenger->confirmed
                   ? uncommon->challenger.get()
                   : nullptr;
    }
};

}  // namespace asip::catalogue
