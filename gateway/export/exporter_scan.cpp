// SPDX-License-Identifier: Apache-2.0
// What the broker retains of an export: read back, and compared with the boards that are there.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/model/json.hpp"
#include "gateway/export/exporter.hpp"

namespace asip::gateway::exports {
namespace {

constexpr std::size_t kMaxSessionsBytes = std::size_t{8} << 20;
constexpr std::size_t kTopicsAtOnce = 256;
constexpr int kMarkDigits = 16;

/// Where documents are, and where they were.
std::set<std::string> places(const Dialect& dialect, const std::optional<Turn::Holder>& holder) {
    auto result = holder ? holder->places : std::set<std::string>();
    result.insert(dialect.place());
    return result;
}

std::set<std::string> filters(const Dialect& dialect, const std::optional<Turn::Holder>& holder) {
    std::set<std::string> result;
    for (const auto& place : places(dialect, holder))
        for (auto& filter : dialect.retained(place))
            result.insert(std::move(filter));
    return result;
}

/// Board -> session, as an exporter published it.
std::map<std::string, std::string> sessions_in(const Dialect::Retained& found, const std::string& topic) {
    std::map<std::string, std::string> result;
    const auto text = found.find(topic);
    if (text == found.end()) return result;
    const auto parsed = model::parse_json(text->second, {.max_bytes = kMaxSessionsBytes, .max_depth = 2});
    if (!parsed || !parsed->is_object()) return result;
    for (const auto& [name, session] : parsed->items())
        if (session.is_string()) result[name] = session.get<std::string>();
    return result;
}

std::string on_bus(const Dialect::Retained& found, const std::string& topic) {
    const auto each = found.find(topic);
    return each == found.end() ? std::string() : each->second;
}

}  // namespace

void Exporter::begin_scan(Time now) {
    phase_ = Phase::kPreparing;
    scan_at_.reset();
    scan_until_ = now + kScanLimit;
    scan_.begin(random_hex(random_, kMarkDigits));
    port_.subscribe(dialect().base() + "/#");
    for (const auto& filter : filters(dialect(), turn_.holder()))
        port_.subscribe(filter);
}

void Exporter::finish_scan() {
    scan_until_.reset();
    port_.unsubscribe(dialect().base() + "/#");
    for (const auto& filter : filters(dialect(), turn_.holder()))
        port_.unsubscribe(filter);
    if (!scan_.complete())
        port_.log("too much is retained below " + dialect().base() + " to be looked through");
    auto& scanned = scanned_.emplace();
    scanned.found = scan_.take_all();
    scanned.places = places(dialect(), turn_.holder());
    scanned.sessions = sessions_in(scanned.found, dialect().sessions());
    gateway_document_ = on_bus(scanned.found, dialect().gateway_document_topic());
    standing_ = on_bus(scanned.found, dialect().standing_topic());
    scanned.wanted.insert(dialect().lease());
    if (options_.enabled)
        scanned.wanted.insert({dialect().sessions(), dialect().gateway_state(),
                               dialect().gateway_document_topic(), dialect().standing_topic()});
    port_.again();
}

/// Boards first, those that came meanwhile among them; then what is left of all that was retained.
void Exporter::look_through(Time now) {
    auto& [found, next, places, sessions, wanted, boards, listed, adopted] = *scanned_;
    if (boards.empty() && !next && options_.enabled)
        for (auto& name : port_.boards())
            if (listed.insert(name).second) boards.push_back(std::move(name));
    if (!boards.empty()) {
        for (std::size_t i = 0; i < kBoardsAtOnce && !boards.empty(); ++i) {
            adopt(boards.back(), now);
            boards.pop_back();
        }
        return port_.again();
    }
    if (!next) {
        forget_others(adopted);
        next = found.begin();
    }
    for (std::size_t i = 0; i < kTopicsAtOnce && *next != found.end(); ++i, ++*next) {
        const auto& topic = (*next)->first;
        const auto ours = [&](const auto& place) { return dialect().is_ours(found, topic, place); };
        if (!wanted.contains(topic) && std::any_of(places.begin(), places.end(), ours))
            clear_.push_back(topic);
    }
    *next == found.end() ? show_all(now) : port_.again();
}

/// What the broker keeps of boards that were not there is cleared: one that comes back is shown anew.
void Exporter::forget_others(const std::set<std::string>& adopted) {
    std::erase_if(records_, [&](const auto& each) {
        const bool forgotten = !adopted.contains(each.first);
        if (forgotten && each.second.there) --online_;
        return forgotten;
    });
}

/// What the broker keeps of a board that is there. It is found no more, but for the board's document, which
/// shows whose its other topics are.
void Exporter::adopt(const std::string& name, Time now) {
    auto present = port_.board(name);
    if (!present) return;
    scanned_->adopted.insert(name);
    auto& found = scanned_->found;
    auto& record = records_[name];
    bool same = record.session == present->session;
    if (const auto known = scanned_->sessions.find(name); !record.board)
        same = known != scanned_->sessions.end() && known->second == present->session;
    const auto taken = [&found](const std::string& topic) {
        auto node = found.extract(topic);
        return node ? std::move(node.mapped()) : std::string();
    };
    const auto document = dialect().document_topic(name);
    record.document = on_bus(found, document);
    scanned_->wanted.insert(document);
    record.document_due = record.values_due = true;
    record.state = taken(dialect().board_state(name));
    record.session = std::move(present->session);
    if (!record.board) take(record, present->board);
    record.targets.clear();
    const auto& properties = record.board->properties;
    for (std::size_t i = 0; i < record.states.size(); ++i) {
        auto& state = record.states[i];
        auto text = state.newest();
        state.adopt(taken(state_topic(record, i)));
        const bool older = !same && !(text.empty() && state.sent().empty());
        if (older)
            text = i < properties.size() ? dialect().state_text(properties[i], nullptr) : std::string();
        // Behind the document.
        if (older || !text.empty()) state.offer(std::move(text), now, between_, false);
        if (state.waits()) pending_.emplace(name, i);
        if (i >= properties.size()) continue;
        const auto target = dialect().target(name, properties[i]);
        if (auto on_target = taken(target); !on_target.empty()) record.targets[target] = std::move(on_target);
    }
}

void Exporter::show_all(Time now) {
    scanned_.reset();
    if (const auto end = dialect().last_cleared(); !end.empty())
        std::stable_partition(clear_.begin(), clear_.end(),
                              [&](const std::string& topic) { return !topic.ends_with(end); });
    for (const auto& [name, record] : records_)
        dirty_.insert(name);  // it may have been forgotten meanwhile
    phase_ = Phase::kActive;
    gateway_due_ = true;
    sessions_due_ = options_.enabled;
    if (options_.enabled) {
        for (auto& name : port_.boards())
            dirty_.insert(std::move(name));
        begin_to_show();
    } else {
        clear_.push_back(dialect().lease());  // last: until then the next start knows of the rest
    }
    pump(now);
}

void Exporter::begin_to_show() {
    if (!dialect().status().empty()) port_.subscribe(dialect().status());
    if (!dialect().read_only()) port_.subscribe(dialect().commands());
    for (const auto& filter : dialect().watched())
        port_.watch(filter);
    if (dialect().changing().empty())
        show_gateway();
    else
        retain(dialect().gateway_state(), dialect().changing());
}

}  // namespace asip::gateway::exports
