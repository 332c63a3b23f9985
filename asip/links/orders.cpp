// SPDX-License-Identifier: Apache-2.0
// What the links do: the second half of Rules.
#include <algorithm>
#include <cmath>

#include "asip/links/rules.hpp"
#include "asip/model/json.hpp"

namespace asip::links {
namespace {

using nlohmann::json;

constexpr auto kSecond = std::chrono::seconds(1);
constexpr int kDay = 24 * 3600;
constexpr auto kLookAtClock = std::chrono::minutes(1);  // it may be set

std::optional<bool> as_bool(const json& value) {
    return value.is_number() ? std::optional(value.get<double>() != 0) : on_of(value);
}

/// A light counts by its brightness.
std::optional<double> as_number(const json& value) {
    if (value.is_number()) return value.get<double>();
    const auto on = as_bool(value);
    if (!on) return std::nullopt;
    if (*on && value.is_object() && value.contains("brightness") && value.at("brightness").is_number())
        return value.at("brightness").get<double>();
    return *on ? property::kFullBrightness : 0;
}

bool stands_so(const json& value, const json& wanted) {
    if (wanted.is_boolean() && !value.is_null()) return as_bool(value) == wanted.get<bool>();
    if (wanted.is_number() && value.is_object()) return as_number(value) == wanted.get<double>();
    return value == wanted;
}

std::string source_of(const Link& link) {
    return link.board + "/" + link.source;
}

json opposite(const Link& link) {
    if (!link.otherwise.is_null()) return link.otherwise;
    if (link.value.is_null()) return false;
    return link.value.is_boolean() ? json(!link.value.get<bool>()) : json();
}

json first_of(const Link& link) {
    return link.value.is_null() ? json(true) : link.value;
}

}  // namespace

bool Rules::in_time(const Link& link) const {
    if (!link.between) return true;
    const int minute = world_.second_of_day() / 60;
    const auto [from, to] = *link.between;
    return from < to ? minute >= from && minute < to : minute >= from || minute < to;
}

/// What the source makes of the target: true, false, or a number. Null: nothing now.
json Rules::output(const Entry& entry) const {
    const auto& link = entry.link;
    if (!entry.source) return {};
    const bool now = in_time(link);
    if (link.when == When::kAbove || link.when == When::kBelow) {
        const auto number = as_number(*entry.source);
        if (!number) return {};
        const bool was = entry.kept.seen == json(true);
        const double at = was ? link.back.value_or(*link.level) : *link.level;
        return now && (link.when == When::kAbove ? *number > at : *number < at);
    }
    const bool number = link.line || (link.when == When::kFollows && link.value.is_null() &&
                                      link.otherwise.is_null() && entry.source->is_number());
    if (!number) {
        const auto on = as_bool(*entry.source);
        return on ? json(now && *on == (link.when != When::kInverted)) : json();
    }
    auto value = as_number(*entry.source);
    if (!value || !now) return {};
    if (link.line) {
        const auto& [from, to, low, high] = *link.line;
        const double part = std::clamp((*value - from) / (to - from), 0.0, 1.0);
        value = std::round((low + part * (high - low)) * 1e6) / 1e6;
    }
    return property::json_number(*value);
}

/// What the target is to be; null: nothing is said.
json Rules::wanted(const Link& link, const json& output, bool over) {
    if (!output.is_boolean()) return output;
    return output.get<bool>() && !over ? first_of(link) : opposite(link);
}

/// At most kMaxASecond; where more come, the target may move its own source.
bool Rules::may_send(Entry& entry, Time now) {
    while (!entry.times.empty() && now - entry.times.front() >= kSecond)
        entry.times.pop_front();
    if (entry.times.size() < kMaxASecond) return true;
    say(entry, "held back: more than 20 commands a second. Does its target move its source?");
    return false;
}

void Rules::send(Entry& entry, Order order, Time now, std::vector<Order>& orders) {
    order.link = entry.link.name;
    entry.times.push_back(now);
    entry.sent = order.value;
    ++entry.in_flight;
    const auto what = order.kind == Order::Kind::kSafe      ? std::string("made safe")
                      : order.kind == Order::Kind::kCommand ? "sent " + model::dump_json(entry.link.command)
                                                            : "set to " + words_of(order.value);
    say(entry, what + ", because " + order.because);
    orders.push_back(std::move(order));
}

/// A level link: the target is made what it is to be, where it is not.
void Rules::make(Entry& entry, Time now, std::vector<Order>& orders, bool ends) {
    const auto& link = entry.link;
    if (entry.kept.suspended || entry.tried || entry.in_flight > 0 || stopped_) return;
    if (!entry.source && (!ends || entry.released)) return;
    if (entry.kept.seen.is_null() || (entry.due && now < *entry.due) || !world_.ready()) return;
    const auto value = wanted(link, entry.kept.seen, entry.kept.over);
    const bool on = entry.kept.seen != json(false) && !entry.kept.over;
    const bool command = !link.command.is_null();
    const bool nothing = command ? !on : value.is_null();
    const auto known = nothing || command ? std::nullopt : world_.value(link.target);
    if (!nothing && !(known && stands_so(*known, value))) {
        if (!may_send(entry, now)) {
            entry.due = entry.times.front() + kSecond;
            return;
        }
        const auto because =
            entry.kept.over ? "its time was over" : source_of(link) + " was " + words_of(*entry.source);
        send(entry, {{}, command ? Order::Kind::kCommand : Order::Kind::kSet, value, because}, now, orders);
        // Nothing tells whether it is still so: a restart sends it no second time.
        if (command) keep(entry, {entry.kept.seen, false, true});
    }
    entry.tried = true;
    entry.due.reset();
    if (on && link.lasts > Duration{}) entry.until = now + link.lasts;
}

/// An event link: what is to be done once.
void Rules::fire(Entry& entry, Time now, std::vector<Order>& orders) {
    const auto& link = entry.link;
    entry.due.reset();
    if (stopped_ || !world_.ready()) return say(entry, "nothing: the board was not there, or stopped");
    if (!may_send(entry, now)) return;
    const auto because =
        source_of(link) + " had a " + std::string(link.when == When::kToggles ? "press" : to_text(link.when));
    if (!link.command.is_null()) return send(entry, {{}, Order::Kind::kCommand, {}, because}, now, orders);
    auto value = first_of(link);
    if (link.when == When::kToggles) {
        auto known = entry.sent ? entry.sent : world_.value(link.target);
        if (!known) known = entry.kept.seen;  // before this agent began
        if (stands_so(*known, value)) value = opposite(link);
        if (value.is_null()) return say(entry, "nothing: there is no other value to switch to");
        keep(entry, {value, false, false});
    }
    send(entry, {{}, Order::Kind::kSet, value, because}, now, orders);
    if (link.lasts == Duration{}) return;
    entry.until = now + link.lasts;
    keep(entry, {true, false, false});
}

/// Its time is over.
void Rules::finish(Entry& entry, Time now, std::vector<Order>& orders) {
    if (!is_event(entry.link.when)) {
        entry.until.reset();
        auto kept = entry.kept;
        kept.over = true;
        keep(entry, std::move(kept));
        entry.tried = false;
        return make(entry, now, orders, true);  // also where the source is not there
    }
    if (!world_.ready()) return;  // as soon as it is there
    entry.until.reset();
    keep(entry, {});
    if (const auto value = opposite(entry.link); !value.is_null())
        send(entry, {{}, Order::Kind::kSet, value, "its time was over"}, now, orders);
}

/// The source is not there: once, whatever comes.
void Rules::release(Entry& entry, Time now, std::vector<Order>& orders) {
    if (!world_.ready()) return;
    entry.gone = Time::max();
    const auto& link = entry.link;
    if (!link.enabled || is_event(link.when) || entry.kept.suspended || entry.kept.seen == json(false) ||
        stopped_ || !(link.safe || world_.dangerous(link)))
        return;
    entry.due.reset();
    entry.released = true;
    send(entry, {{}, Order::Kind::kSafe, {}, source_of(link) + " was not there"}, now, orders);
}

std::vector<Order> Rules::run(Time now) {
    std::vector<Order> orders;
    clock_at_.reset();
    for (auto& [name, entry] : links_) {
        const bool event = is_event(entry.link.when);
        if (entry.gone && now >= *entry.gone) release(entry, now, orders);
        if (!entry.link.enabled) continue;
        if (entry.link.between) {
            look(entry, now);
            look_at_clock(*entry.link.between, now);
        }
        if (entry.until && now >= *entry.until) finish(entry, now, orders);
        if (event && entry.due && now >= *entry.due)
            for (int left = std::exchange(entry.events, 0); left > 0; --left)
                fire(entry, now, orders);
        if (!event && !entry.gone) make(entry, now, orders);
    }
    return orders;
}

/// At the next of two times of day; soon, for the clock may be set.
void Rules::look_at_clock(const std::pair<int, int>& between, Time now) {
    const int second = world_.second_of_day();
    for (const int minute : {between.first, between.second}) {
        const Duration until = std::chrono::seconds((minute * 60 - second - 1 + kDay) % kDay + 1);
        const auto at = now + std::min<Duration>(until, kLookAtClock);
        if (!clock_at_ || at < *clock_at_) clock_at_ = at;
    }
}

std::optional<Time> Rules::next_deadline() const {
    auto first = clock_at_;
    const auto take = [&first](const std::optional<Time>& when) {
        if (when && *when != Time::max() && (!first || *when < *first)) first = when;
    };
    if (!world_.ready()) return first;
    for (const auto& [name, entry] : links_) {
        take(entry.gone);
        take(entry.until);
        const bool waits = is_event(entry.link.when) || (entry.in_flight == 0 && !entry.kept.suspended &&
                                                         !stopped_ && entry.source && !entry.gone);
        if (waits) take(entry.due);
    }
    return first;
}

}  // namespace asip::links
