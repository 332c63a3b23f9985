// SPDX-License-Identifier: Apache-2.0
#include "asip/links/rules.hpp"

namespace asip::links {
namespace {

using nlohmann::json;

}  // namespace

void Rules::set(Link link, Kept kept, Time now) {
    const auto name = link.name;
    auto& entry = links_[name];
    entry = Entry();
    entry.link = std::move(link);
    entry.kept = std::move(kept);
    // What it began before its agent ended is brought to its end.
    const auto& seen = entry.kept.seen;
    if (!is_event(entry.link.when)) {
        if (!seen.is_null() && seen != json(false) && entry.link.after > Duration{})
            entry.due = now + entry.link.after;
    } else if (entry.link.enabled && entry.link.lasts > Duration{} && seen == json(true)) {
        entry.until = now + entry.link.lasts;
    }
    changed_.insert(name);
}

void Rules::remove(const std::string& name) {
    links_.erase(name);
    changed_.insert(name);
}

void Rules::enable(const std::string& name, bool enabled) {
    const auto found = links_.find(name);
    if (found == links_.end() || found->second.link.enabled == enabled) return;
    auto& entry = found->second;
    entry.link.enabled = enabled;
    // Enabled again, it acts at the next change, and brings nothing to its end.
    const bool event = is_event(entry.link.when);
    if (entry.link.lasts > Duration{} && event) entry.kept.seen = {};
    if (const auto made = output(entry); !event && !made.is_null()) entry.kept.seen = made;
    entry.kept.suspended = !event;
    entry.due.reset();
    entry.until.reset();
    changed_.insert(name);
}

void Rules::keep(Entry& entry, Kept kept) {
    if (entry.kept == kept) return;
    entry.kept = std::move(kept);
    changed_.insert(entry.link.name);
}

void Rules::say(Entry& entry, std::string cause) {
    if (entry.cause == cause) return;
    entry.cause = std::move(cause);
    changed_.insert(entry.link.name);
}

/// Where the source says something else than before, the link begins anew with it.
void Rules::look(Entry& entry, Time now) {
    if (!entry.link.enabled || is_event(entry.link.when)) return;
    const auto made = output(entry);
    if (made.is_null() || made == entry.kept.seen) return;
    keep(entry, {made, stopped_, false});
    entry.tried = false;
    entry.until.reset();
    entry.due = made != json(false) && entry.link.after > Duration{} ? std::optional(now + entry.link.after)
                                                                     : std::nullopt;
}

void Rules::source(std::string_view board, std::string_view id, const std::optional<json>& value, Time now) {
    for (auto& [name, entry] : links_) {
        if (entry.link.board != board || entry.link.source != id) continue;
        entry.source = value;
        if (!value) continue;
        entry.heard = true;
        // It made the target safe, and is back.
        if (std::exchange(entry.released, false)) entry.tried = false;
        entry.gone.reset();
        look(entry, now);
    }
}

void Rules::act(std::string_view board, std::string_view id, property::ButtonAct act, Time now) {
    const auto when = when_of(to_text(act));  // of the same words
    for (auto& [name, entry] : links_) {
        const auto& link = entry.link;
        if (link.board != board || link.source != id || !link.enabled || !in_time(link)) continue;
        if (link.when != when && !(link.when == When::kToggles && when == When::kPress)) continue;
        if (stopped_ || !world_.ready()) {
            say(entry,
                std::string(stopped_ ? "nothing: the board is stopped" : "nothing: the board was not there"));
            continue;
        }
        // Each press switches; of others, and of those that wait, the last one counts.
        entry.events = when == When::kPress && link.when == When::kToggles && link.after == Duration{}
                           ? entry.events + 1
                           : 1;
        entry.due = now + link.after;
    }
}

void Rules::present(std::string_view board, bool is, Time now) {
    for (auto& [name, entry] : links_) {
        if (entry.link.board != board) continue;
        if (is && entry.gone != Time::max()) entry.gone.reset();
        if (!is && !entry.gone && entry.heard) entry.gone = now + kGone;
    }
}

void Rules::target_back() {
    const bool restarted = std::exchange(was_there_, true);
    for (auto& [name, entry] : links_) {
        entry.tried = false;
        if (restarted && entry.link.when == When::kToggles) keep(entry, {});
    }
}

/// A person wins: until the source changes.
void Rules::suspend(Entry& entry, const std::string& why) {
    entry.due.reset();
    entry.until.reset();
    auto kept = entry.kept;
    if (is_event(entry.link.when))
        kept.seen =
            entry.link.when == When::kToggles ? world_.value(entry.link.target).value_or(json()) : json();
    else
        kept.suspended = true;
    if (kept != entry.kept && !is_event(entry.link.when)) say(entry, why);
    keep(entry, std::move(kept));
}

void Rules::executed(const std::string& target, std::string_view link) {
    for (auto& [name, entry] : links_)
        if (name != link && entry.link.target == target)
            suspend(entry, link.empty() ? "nothing, until the source changes: another client set the target"
                                        : "nothing, until the source changes: link " + std::string(link) +
                                              " set the target");
}

void Rules::stopped(bool latched) {
    stopped_ = stopped_ || latched;
    for (auto& [name, entry] : links_)
        suspend(entry, "nothing, until the source changes: the board was stopped");
}

void Rules::finished(const std::string& link, bool ok, const std::string& text) {
    const auto found = links_.find(link);
    if (found == links_.end()) return;
    auto& entry = found->second;
    if (entry.in_flight > 0) --entry.in_flight;
    if (entry.in_flight == 0) entry.sent.reset();
    if (!ok) say(entry, "failed: " + text);
}

}  // namespace asip::links
