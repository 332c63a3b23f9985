// SPDX-License-Identifier: Apache-2.0
// Boards, their values and commands for them; when there is a session of the node: sparkplug_node.cpp.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/model/json.hpp"
#include "asip/text/printable.hpp"
#include "gateway/export/dialect.hpp"
#include "gateway/export/sparkplug_node.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

// Values of the property "Quality".
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
    if (!dirty_.empty() && port_.has_room()) port_.again();
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
    const bool changed = record.is_other(*present->board);
    if (changed) take(record, std::move(present->board));
    const bool other = std::exchange(record.session, present->session) != present->session;
    if (!record.there || (other && record.born)) death(record);  // it may have forgotten what was set
    if (record.there && (changed || !record.born)) birth(record, now);
}

void SparkplugNode::take(Record& record, std::shared_ptr<const ExportedBoard> board) {
    std::map<std::string, State> old;
    for (std::size_t i = 0; i < record.states.size(); ++i)
        old[record.board->properties[i].id] = std::move(record.states[i]);
    take_up(record, std::move(board), [this](const ExportedBoard& each) { return birth_bytes(each); });
    record.states.clear();
    record.states.resize(record.board->properties.size());
    record.slots.clear();
    for (std::size_t i = 0; i < record.states.size(); ++i) {
        const auto& property = record.board->properties[i];
        if (auto kept = old.find(property.id); kept != old.end()) record.states[i] = std::move(kept->second);
        if (property.kind == Kind::kButton && names_.read_only) continue;
        for (auto& slot : Sparkplug::slots(property))
            record.slots.push_back({std::move(slot), i, 0});
    }
}

/// Without values.
std::size_t SparkplugNode::birth_bytes(const ExportedBoard& board) const {
    sparkplug::Payload payload;
    for (const auto& property : board.properties) {
        if (property.kind == Kind::kButton && names_.read_only) continue;
        for (auto& metric : Sparkplug::slots(property)) {
            auto& each = payload.metrics.emplace_back();
            each.name = metric.name;
            each.alias = each.timestamp = std::uint64_t{1} << 48;
            each.properties = dialect_.properties(property, metric);
        }
    }
    return sparkplug::write(payload).size();
}

sparkplug::Metric SparkplugNode::metric(const Record& record, const Slot& slot, std::uint64_t time_ms) const {
    const auto& state = record.states[slot.property];
    sparkplug::Metric result;
    result.alias = slot.alias;
    result.timestamp = time_ms;
    result.type = slot.metric.type;
    result.value = Sparkplug::value(record.board->properties[slot.property], slot.metric,
                                    value_from(state.value.sent()));
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
        auto properties = dialect_.properties(record.board->properties[slot.property], slot.metric);
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
    record.states.resize(record.board->properties.size());
    if (!std::exchange(record.born, false)) return;
    say(dialect_.topic("DDEATH", record.board->board), {});
}

// --- values

SparkplugNode::Record* SparkplugNode::living(const std::string& board) {
    const auto found = phase_ == Phase::kActive ? records_.find(board) : records_.end();
    return found != records_.end() && found->second.there ? &found->second : nullptr;
}

void SparkplugNode::value(std::string_view board, std::string_view service, std::string_view text, Time now) {
    auto* record = living(std::string(board));
    if (record == nullptr) return;
    const auto properties = record->by_service.find(service);
    if (properties == record->by_service.end()) return;
    std::uint64_t refused = 0;
    std::vector<std::size_t> changed;
    for (const auto& each : reported_values(*record->board, properties->second, text, refused))
        if (take_value(*record, each.property, each.value, now)) changed.push_back(each.property);
    if (refused > 0) port_.refused(refused);
    show(*record, changed, now);
}

void SparkplugNode::known(const std::string& board, const std::vector<std::string>& ids, Time now) {
    auto* record = living(board);
    if (record == nullptr) return;
    const auto& properties = record->board->properties;
    std::vector<std::size_t> changed;
    for (std::size_t i = 0; i < properties.size(); ++i)
        if (properties[i].kind != Kind::kButton && is_one_of(properties[i], ids) &&
            take_value(*record, i, port_.value(board, properties[i]), now))
            changed.push_back(i);
    show(*record, changed, now);
}

void SparkplugNode::show(Record& record, const std::vector<std::size_t>& changed, Time now) {
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
void SparkplugNode::publish_data(Record& record, const std::vector<std::size_t>& properties) {
    const auto time = time_ms();
    sparkplug::Payload payload;
    for (const auto& slot : record.slots)
        for (const auto index : properties)
            if (slot.property == index) payload.metrics.push_back(metric(record, slot, time));
    for (const auto index : properties)
        if (auto& state = record.states[index]; std::exchange(state.fault_due, false)) state.fault_at = now_;
    if (!payload.metrics.empty()) say(dialect_.topic("DDATA", record.board->board), std::move(payload));
}

void SparkplugNode::all_values(Record& record, Time now) {
    const auto& board = *record.board;
    for (std::size_t i = 0; i < board.properties.size(); ++i)
        if (board.properties[i].kind != Kind::kButton)
            take_value(record, i, port_.value(board.board, board.properties[i]), now);
}

/// True: it is another one now, and waits to be said. What is not known any more is said where something else
/// was said before.
bool SparkplugNode::take_value(Record& record, std::size_t index, const std::optional<json>& value,
                               Time now) {
    auto& state = record.states[index].value;
    if ((!value || value->is_null()) && state.sent().empty()) return false;
    state.offer(model::dump_json(value.value_or(nullptr)), now, between_, false);
    return true;
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
        wanted[slot->property].push_back({slot->metric.part, each.value});
    }
    for (const auto& [property, values] : wanted)
        command(name, property, values);
}

void SparkplugNode::command(const std::string& name, std::size_t index,
                            const std::vector<Sparkplug::Wanted>& wanted) {
    const auto& record = records_[name];
    const auto& property = record.board->properties[index];
    const auto value = dialect_.value_of(property, wanted, value_from(record.states[index].value.sent()));
    if (!value) return answered(name, property.id, value.error());
    if (!record.there) return answered(name, property.id, property.name + ": the board is not there");
    if (!property.refused.empty()) return answered(name, property.id, property.refused);
    for (const auto& request : requests_for(property, *value))
        port_.command(name, request,
                      [this, name, id = property.id, title = property.name](const std::string& fault) {
                          answered(name, id, fault.empty() ? fault : title + ": " + fault);
                      });
}

/// The metric stays as it is; its quality says what became of the last command.
void SparkplugNode::answered(const std::string& name, const std::string& id, const std::string& fault) {
    if (!fault.empty())
        seldom_.say(name + "/" + id, "board " + name + ": a command of a Sparkplug host failed: " + fault,
                    now_);
    const auto found = records_.find(name);
    if (phase_ != Phase::kActive || found == records_.end()) return;
    auto& record = found->second;
    const auto* property = record.board->property(property::plain_id(id));
    if (property == nullptr || !record.born) return;
    const auto index = static_cast<std::size_t>(property - record.board->properties.data());
    auto& state = record.states[index];
    if (state.fault == fault) return;
    state.fault = fault;
    state.fault_due = true;
    pending_.emplace(name, index);
}

}  // namespace asip::gateway::exports
