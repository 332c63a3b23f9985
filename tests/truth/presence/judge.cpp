// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace truth::presence {
namespace {

using namespace std::chrono_literals;
using asip::model::to_text;

// A machine that is gone is in every view so long after its lease.
constexpr Duration kPromisedOfLeases = 2s;
// A registry judges no lease for so long after it heard the bus again.
constexpr Duration kGrace = 12s;
// Another registry that does not answer is waited for.
constexpr Duration kComplete = 15s;

}  // namespace

double seconds(Time time) {
    return std::chrono::duration<double>(time - kBegin).count();
}

Duration Judge::settling() const {
    return setting_.in_order ? kPromised : kPromised + std::chrono::milliseconds(setting_.lease * 400);
}

Time Judge::last_description(const std::string& board) const {
    Time last{};
    for (const auto& [at, message] : broker_.published())
        if (message.topic == "asip/servicebus/" + board + "/$description") last = at;
    return last;
}

std::string Judge::told(const View& view, const std::string& board, const BoardTruth& truth) const {
    if (!setting_.in_order || !setting_.says_state) return {};
    const auto changes = view.changes_of(board);
    auto said = truth.words.begin();
    for (std::size_t i = 0; i < changes.size(); ++i) {
        if (changes[i] == View::kReset) continue;
        const bool twice = i > 0 && changes[i] == changes[i - 1];
        if (!twice && changes[i] == "lost expired") continue;
        said = std::find_if(said, truth.words.end(), [&](const auto& word) {
            return word.text == changes[i] && !(word.unless_heard && view.heard(*word.unless_heard));
        });
        if (twice || said == truth.words.end()) return "told too often that it is " + changes[i] + ":";
    }
    return {};
}

// An agent that asks whether another session lives has the broker keep nothing of what it says, and an
// earlier session overwrites what the broker keeps of a later one. A view that did not hear what was said
// last, and has heard nothing since it has the bus, knows what is kept. It would be the same had that not
// been said: no rule can tell these two. A view that was there when an earlier session's description took the
// place of the later one's, and since, knows better. One that started behind that has what the broker stores.
// One that was away believes the stored description if the lease of the later session that it knows was over,
// or takes the stored word for a later session whose lease is over.
std::vector<Really> Judge::possible(const View& view, const BoardTruth& truth, Time now) const {
    std::vector<Really> possible{truth.really(now)};
    if (truth.at_end) possible.push_back(truth.at_end->really(now));
    if (view.connected_at() > truth.last_said() && !view.heard(truth.described_at))
        for (const auto& kept : truth.all_kept(now))
            possible.push_back(kept);
    if (!truth.in_vain) return possible;
    const Time at = truth.in_vain->at;
    if (view.heard(at) && view.connected_at() < at) return possible;
    possible.push_back(truth.last_in_vain.really(now));
    possible.push_back(truth.in_vain->really(now));
    if (view.started_at() <= at) possible.push_back({true, BoardState::kLost, StateReason::kExpired, at, at});
    return possible;
}

std::string Judge::says(View& view, const std::string& board, const BoardTruth& truth, Time now,
                        std::uint64_t& compared) const {
    // A change that is still under way, or a will that its agent puts right.
    if (now - truth.really(now).since < kPromised || now - truth.last_will < settling()) return {};
    if (!setting_.in_order && truth.unordered_word) return {};
    const auto seen = view.board(board, now);
    if (!view.is_complete()) return now - view.connected_at() > kComplete ? "is not complete" : "";
    ++compared;
    std::string wrong;
    for (const auto& really : possible(view, truth, now))
        if (wrong = differs(view, seen, really, truth, now); wrong.empty()) break;
    return wrong;
}

std::string Judge::differs(const View& view, const std::optional<asip::bus::BoardItem>& seen,
                           const Really& really, const BoardTruth& truth, Time now) const {
    if (!really.announced) return seen ? "has a board that never announced itself" : "";
    // A lease that ran out is judged when the program had time to hear of a renewal.
    if (really.reason == StateReason::kExpired &&
        now < std::max(really.since + kPromisedOfLeases, view.connected_at() + kGrace))
        return {};
    if (!seen) return "has no such board";
    if (seen->state != to_text(really.state)) return "says " + seen->state;
    return reason_and_time(view, *seen, really, truth, now);
}

std::string Judge::reason_and_time(const View& view, const asip::bus::BoardItem& seen, const Really& really,
                                   const BoardTruth& truth, Time now) const {
    const bool judged = really.reason == StateReason::kExpired;
    // A will is no news of a board that a view knew as lost, where it was away as the board was there.
    const bool heard = view.heard(really.said_at) &&
                       (really.reason != StateReason::kAgentGone || view.heard(truth.there_at));
    // The broker has the word of the state alone where an agent is gone for longer than a lease, or where
    // another overwrote its description before it ended. It has no description of an agent that asked whether
    // another session lives until it ended: a view that was away does not learn that the board was there.
    const bool knows_why =
        setting_.says_state &&
        (heard || (!judged && std::min(now, view.connected_at() + kPromised) < truth.stored_until));
    // A will behind an earlier session's description is that board's first one for a view that believes it.
    const bool believes_other =
        truth.vain_at >= really.since && (!view.heard(truth.vain_at) || view.connected_at() > truth.vain_at);
    if (!knows_why || believes_other) return {};
    const bool in_conflict = seen.reason == "conflict" && really.reason == StateReason::kNone;
    if (seen.reason != to_text(really.reason) && !in_conflict)
        return "says " + seen.state + " " + seen.reason;
    const auto tolerance = setting_.in_order ? Duration(2s) : Duration(3s);
    const auto is_since = [&](Time since) {
        const auto difference = seen.since - instant(since).wall;
        return difference <= tolerance && difference >= -tolerance;
    };
    // Another will of a board that was lost already changes nothing but what is stored.
    const bool again = really.reason == StateReason::kAgentGone &&
                       !(view.heard(really.said_at) && view.heard(truth.last_will));
    const auto behind = [&](Time will) { return will >= really.since && is_since(will); };
    if (is_since(really.since) || (again && std::any_of(truth.wills.begin(), truth.wills.end(), behind)))
        return {};
    return fmt::format("says {} since {:.3f} s", seen.state,
                       std::chrono::duration<double>(seen.since - instant(kBegin).wall).count());
}

}  // namespace truth::presence
