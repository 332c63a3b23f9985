// SPDX-License-Identifier: Apache-2.0
#include "gateway/mirror/standing.hpp"

namespace asip::gateway {
namespace {

using property::ShownValue;

bool stands_alike(const ShownValue& a, const ShownValue& b) {
    return a.value == b.value && a.how == b.how && a.why == b.why;
}

}  // namespace

/// A document of the session in the description counts, else that of the later session; within one session
/// the later document.
bool Standing::may_replace(const property::DocumentHead& old, const property::DocumentHead& head,
                           const std::string& board, std::string_view session) {
    if (head.board != board) {
        ++counters_.damaged;
        return false;
    }
    bool good = head.session == session;
    if (head.session == old.session)
        good = head.seq >= old.seq;
    else if (!good)  // its description may be on its way
        good = (old.session.empty() || old.session != session) && head.session >= old.session &&
               head.session >= session;
    if (!good) ++counters_.outdated;
    return good;
}

Standing::Change Standing::take_list(const std::string& board, std::string_view text,
                                     std::string_view session) {
    Change change;
    if (text.empty()) {
        const auto found = boards_.find(board);
        if (found == boards_.end() || !found->second.list.there()) return change;
        found->second.list = {};
        change.list = true;
        return change;
    }
    auto parsed = property::parse_list(text);
    if (!parsed) {
        ++counters_.damaged;
        return change;
    }
    auto& kept = boards_[board].list;
    if (!may_replace(kept.head, parsed->head, board, session)) return change;
    change.anew = kept.head.session != parsed->head.session;
    kept.head = std::move(parsed->head);
    kept.seen = true;
    if (!change.anew && kept.document && *kept.document == parsed->properties) return change;
    kept.document = std::make_shared<const std::vector<property::Property>>(std::move(parsed->properties));
    change.list = true;
    return change;
}

Standing::Change Standing::take_values(const std::string& board, std::string_view text,
                                       std::string_view session, Time now, bool stored) {
    Change change;
    decltype(property::ValueDocument::values) values;
    auto& known = boards_[board];
    auto& kept = known.values;
    if (!text.empty()) {
        auto parsed = property::parse_values(text);
        if (!parsed) {
            ++counters_.damaged;
            return change;
        }
        if (!may_replace(kept.head, parsed->head, board, session)) return change;
        values = std::move(parsed->values);
        change.anew =
            kept.there() && (kept.head.session != parsed->head.session || known.restarts != parsed->restarts);
        known.restarts = parsed->restarts;
        kept.head = std::move(parsed->head);
        std::uint64_t last = known.session_of_act == kept.head.session ? known.last_act : 0;
        change.acts = property::new_acts(values, last);
        if (!change.acts.empty()) known.session_of_act = kept.head.session, known.last_act = last;
        if (stored) change.acts.clear();
    }
    for (const auto& [id, value] : values) {
        const auto old = kept.document.find(id);
        if (old == kept.document.end() || !stands_alike(old->second, value)) change.ids.push_back(id);
    }
    for (const auto& [id, value] : kept.document)
        if (!values.contains(id)) change.ids.push_back(id);
    kept.document = std::move(values);
    kept.at = now;
    kept.seen = true;
    if (text.empty()) kept.head = {};
    return change;
}

void Standing::reading() {
    for (auto& [name, board] : boards_)
        board.list.seen = board.values.seen = false;
}

std::vector<std::string> Standing::complete(const std::function<bool(const std::string&)>& known) {
    std::vector<std::string> gone;
    for (auto each = boards_.begin(); each != boards_.end();) {
        auto& [name, board] = *each;
        const bool less =
            (board.list.there() && !board.list.seen) || (board.values.there() && !board.values.seen);
        if (!board.list.seen) board.list = {};
        if (!board.values.seen) board.values = {};
        if (less) gone.push_back(name);
        each = known(name) ? std::next(each) : boards_.erase(each);
    }
    return gone;
}

Standing::List Standing::list(std::string_view board, std::string_view session) const {
    const auto found = boards_.find(board);
    if (found == boards_.end() || found->second.list.head.session != session) return nullptr;
    return found->second.list.document;
}

std::optional<ShownValue> Standing::value(std::string_view board, std::string_view session,
                                          std::string_view id, Time now) const {
    const auto found = boards_.find(board);
    if (found == boards_.end() || found->second.values.head.session != session) return std::nullopt;
    const auto& kept = found->second.values;
    const auto value = kept.document.find(id);
    if (value == kept.document.end()) return std::nullopt;
    auto shown = value->second;
    shown.age += std::chrono::duration<double>(now - kept.at).count();
    return shown;
}

std::shared_ptr<void> Standing::listen(Listener listener) {
    auto place = listeners_->insert(listeners_->end(), std::move(listener));
    return {nullptr, [all = std::weak_ptr(listeners_), place](void*) {
                if (const auto listeners = all.lock()) listeners->erase(place);
            }};
}

void Standing::tell(const std::string& board, const Change& change) const {
    for (auto each = listeners_->begin(); each != listeners_->end();)
        (*each++)(board, change);
}

}  // namespace asip::gateway
