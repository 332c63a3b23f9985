// SPDX-License-Identifier: Apache-2.0
// Boards, their values and commands for them; when there is a session of the node: sparkplug_node.cpp.
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/model/json.hpp"
#include "asip/text/printable.hpp"
#include "gateway/export/dialect.hpp"
#include "gateway/export/sparkplug_node.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

// Of the property "Quality".
constexpr std::int64_t kBad = 0;
constexpr std::int64_t kGood = 192;
constexpr int kBoardsAtOnce = 20;  // births; the rest when these are on their way: a command is not behind
                                   // all of them
constexpr const char* kQuality = "Quality";
constexpr const char* kError = "error";

json value_from(const std::string& text) {
    if (text.empty()) return {};
    auto parsed = model::parse_json(text);
    return parsed ? std::move(*parsed) : json();
}

}  // namespace

// --- boards

void SparkplugNode::pump(Time now) {
    for (int i = 0; i < kBoardsAtOnce && !dirty_.empty() && port_.has_room(); ++i) {
        const auto name = *dirty_.begin();
        dirty_.erase(dirty_.begin());
        update(name, now);
    }
}

void SparkplugNode::sent(Time now) {
    if (phase_ != Phase::kActive || dirty_.empty()) return;
    now_ = now;
    pump(now);
}

void SparkplugNode::update(const std::string& name, Time now) {
    auto present = port_.board(name);
    auto found = records_.find(name);
    if (!present) {
        if (found == records_.end()) return;
        death(found->second);
        records_.erase(found);
        return;
    }
    if (found == records_.end()) found = records_.try_emplace(name).first;
    auto& record = found->second;
    record.there = present->there;
    const bool changed =
        record.board != present->board && (!record.board || !(*record.board == *present->board));
    if (changed) take(record, std::move(present->board));
    const bool other = std::exchange(record.session, present->session) != present->session;
    if (!record.there || (other && record.born)) death(record);  // it may have forgotten what was set
    if (record.there && (changed || !record.born)) birth(record, now);
}

void SparkplugNode::take(Record& record, std::shared_ptr<const ExportedBoard> board) {
    std::map<std::string, State> old;
    for (std::size_t i = 0; i < record.states.size(); ++i)
        old[record.board->entities[i].id] = std::move(record.states[i]);
    record.board = std::move(board);
    record.states.clear();
    record.states.resize(record.board->entities.size());
    record.slots.clear();
    record.by_service.clear();
    for (std::size_t i = 0; i < record.states.size(); ++i) {
        const auto& entity = record.board->entities[i];
        if (auto kept = old.find(entity.id); kept != old.end()) record.states[i] = std::move(kept->second);
        if (entity.kind != EntityKind::kButton)
            record.by_service[entity.service()].push_back(i);
        else if (options_.dialect.read_only)
            continue;
        for (auto& slot : Sparkplug::slots(entity))
            record.slots.push_back({std::move(slot), i, 0});
    }
    std::vector<bus::Demander::Want> wants;
    for (const auto& [service, entities] : record.by_service)
        wants.push_back(port_.want(record.board->board, service, options_.per_second));
    record.wants = std::move(wants);
}

sparkplug::Metric SparkplugNode::metric(const Record& record, const Slot& slot, std::uint64_t time_ms) const {
    const auto& state = record.states[slot.entity];
    sparkplug::Metric result;
    result.alias = slot.alias;
    result.timestamp = time_ms;
    result.type = slot.metric.type;
    result.value =
        Sparkplug::value(record.board->entities[slot.entity], slot.metric, value_from(state.value.sent()));
    if (!state.fault.empty()) {
        result.properties.push_back({kQuality, kBad});
        result.properties.push_back({kError, state.fault});
    } else if (state.fault_due) {
        result.properties.push_back({kQuality, kGood});
    }
    return result;
}

/// With all that is known of it. Aliases are new ones each time: Eclipse Tahu takes one that it knows for a
/// fault, also of a device that died.
void SparkplugNode::birth(Record& record, Time now) {
    all_values(record, now);
    const auto time = time_ms();
    for (auto& state : record.states)
        state.value.take(now, Duration::zero(), true);
    sparkplug::Payload payload;
    for (auto& slot : record.slots) {
        slot.alias = next_alias_++;
        auto each = metric(record, slot, time);
        each.name = slot.metric.name;
        auto properties = dialect_.properties(record.board->entities[slot.entity], slot.metric);
        each.properties.insert(each.properties.end(), properties.begin(), properties.end());
        payload.metrics.push_back(std::move(each));
    }
    for (auto& state : record.states)
        state.fault_due = false;
    record.born = true;
    say(dialect_.topic("DBIRTH", record.board->board), std::move(payload));
}

void SparkplugNode::death(Record& record) {
    record.states.clear();
    record.states.resize(record.board->entities.size());
    if (!std::exchange(record.born, false)) return;
    say(dialect_.topic("DDEATH", record.board->board), {});
}

// --- values

void SparkplugNode::value(std::string_view board, std::string_view service, std::string_view text, bool set,
                          Time now) {
    if (phase_ != Phase::kActive) return;
    const auto found = records_.find(std::string(board));
    if (found == records_.end() || !found->second.there) return;
    auto& record = found->second;
    const auto changed = take_values(record, service, text, set, now);
    std::vector<std::size_t> due;
    for (const auto index : changed) {
        auto& state = record.states[index];
        if (record.born && state.value.take(now, between_, port_.has_room()))
            due.push_back(index);
        else if (state.value.waits())
            pending_.emplace(record.board->board, index);
    }
    if (!due.empty()) publish_data(record, due);
}

/// One message for all of them.
void SparkplugNode::publish_data(Record& record, const std::vector<std::size_t>& entities) {
    const auto time = time_ms();
    sparkplug::Payload payload;
    for (const auto& slot : record.slots)
        for (const auto index : entities)
            if (slot.entity == index) payload.metrics.push_back(metric(record, slot, time));
    for (const auto index : entities)
        if (auto& state = record.states[index]; std::exchange(state.fault_due, false)) state.fault_at = now_;
    if (!payload.metrics.empty()) say(dialect_.topic("DDATA", record.board->board), std::move(payload));
}

void SparkplugNode::all_values(Record& record, Time now) {
    for (const auto& [service, entities] : record.by_service)
        port_.values(record.board->board, service,
                     [&](std::string_view text, bool set) { take_values(record, service, text, set, now); });
}

/// The entities whose value is another one now; it waits to be said.
std::vector<std::size_t> SparkplugNode::take_values(Record& record, std::string_view service,
                                                    std::string_view text, bool set, Time now) {
    std::vector<std::size_t> result;
    const auto found = record.by_service.find(service);
    if (found == record.by_service.end()) return result;
    for (const auto& [index, value] : shown_values(*record.board, found->second, text, set)) {
        auto& state = record.states[index];
        // What is not known any more is said where something else was said before.
        if (!value && state.value.sent().empty()) continue;
        state.value.offer(model::dump_json(value.value_or(nullptr)), now, between_, false);
        result.push_back(index);
    }
    return result;
}

// --- commands

void SparkplugNode::node_command(const mqtt::Message& message, Time now) {
    const auto payload = read(message);
    if (!payload) return;
    for (const auto& each : payload->metrics) {
        if (each.name != Sparkplug::kRebirth) {
            log_seldom(++counters_.unknown, "a Sparkplug host sets " +
                                                text::printable(each.name, kShownBytes) +
                                                " of the gateway, which is not there");
        } else if (each.value == sparkplug::Value(true)) {
            if (!born_at_ || now - *born_at_ >= kBetweenBirths) return births(now);
            births_due_ = *born_at_ + kBetweenBirths;
        }
    }
}

void SparkplugNode::board_command(const std::string& name, const mqtt::Message& message) {
    const auto payload = read(message);
    if (!payload) return;
    const auto found = records_.find(name);
    std::map<std::size_t, std::vector<Sparkplug::Wanted>> wanted;
    for (const auto& each : payload->metrics) {
        const Slot* slot = nullptr;
        if (found != records_.end())
            for (const auto& candidate : found->second.slots)
                if (each.name.empty() ? each.alias == candidate.alias : each.name == candidate.metric.name)
                    slot = &candidate;
        if (slot == nullptr) {
            log_seldom(++counters_.unknown,
                       "a Sparkplug host sets " +
                           text::printable(name + "/" + (each.name.empty() ? "?" : each.name), kShownBytes) +
                           ", which is not there");
            continue;
        }
        wanted[slot->entity].push_back({slot->metric.part, each.value});
    }
    for (const auto& [entity, values] : wanted)
        command(name, entity, values);
}

void SparkplugNode::command(const std::string& name, std::size_t index,
                            const std::vector<Sparkplug::Wanted>& wanted) {
    const auto& record = records_[name];
    const auto& entity = record.board->entities[index];
    const auto value = dialect_.value_of(entity, wanted, value_from(record.states[index].value.sent()));
    if (!value) return answered(name, entity.id, value.error());
    if (!record.there) return answered(name, entity.id, entity.name + ": the board is not there");
    for (const auto& request : requests_for(entity, *value))
        port_.command(name, request,
                      [this, name, id = entity.id, title = entity.name](const std::string& fault) {
                          answered(name, id, fault.empty() ? fault : title + ": " + fault);
                      });
}

/// The metric stays as it is; its quality says what became of the last command.
void SparkplugNode::answered(const std::string& name, const std::string& id, const std::string& fault) {
    if (!fault.empty()) port_.log("board " + name + ": a command of a Sparkplug host failed: " + fault);
    const auto found = records_.find(name);
    if (phase_ != Phase::kActive || found == records_.end()) return;
    auto& record = found->second;
    const auto* entity = record.board->entity(id);
    if (entity == nullptr || !record.born) return;
    const auto index = static_cast<std::size_t>(entity - record.board->entities.data());
    auto& state = record.states[index];
    if (state.fault == fault) return;
    state.fault = fault;
    state.fault_due = true;
    pending_.emplace(name, index);
}

}  // namespace asip::gateway::exports
