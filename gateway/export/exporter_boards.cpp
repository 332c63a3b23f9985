// SPDX-License-Identifier: Apache-2.0
// Boards, their values and commands for them; when there is a connection and which gateway exports:
// exporter.cpp.
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/model/json.hpp"
#include "asip/text/printable.hpp"
#include "gateway/export/exporter.hpp"

namespace asip::gateway::exports {

using nlohmann::json;

// --- boards

void Exporter::clear_some() {
    while (!clear_.empty() && port_.has_room()) {
        retain(std::move(clear_.front()), {});
        clear_.pop_front();
    }
}

/// What was said last on topics that others emptied.
void Exporter::put_back(Time now) {
    std::set<std::string> waiting;
    const auto again = [&](const std::string& topic, const std::string& text, int qos = 1) {
        if (text.empty() || emptied_.erase(topic) == 0) return;
        if (port_.has_room())
            retain(topic, text, qos);
        else
            waiting.insert(topic);
    };
    again(dialect().gateway_document_topic(), gateway_document_);
    again(dialect().standing_topic(), standing_);
    if (emptied_.erase(dialect().sessions()) > 0) sessions_due_ = true, sessions_at_ = {};
    for (const auto& [name, record] : records_) {
        if (emptied_.empty()) break;
        if (!record.board) continue;
        again(dialect().document_topic(name), record.document);
        for (const auto& [topic, payload] : record.targets)
            again(topic, payload, dialect().state_qos());
        for (std::size_t i = 0; i < record.states.size(); ++i)
            again(state_topic(record, i), record.states[i].sent(), dialect().state_qos());
        again(dialect().board_state(name), record.state);
    }
    emptied_ = std::move(waiting);
    put_back_at_.reset();
    if (!emptied_.empty()) put_back_at_ = now + kPutBack;
}

void Exporter::pump(Time now) {
    clear_some();
    if (!clear_.empty()) return;
    if (!options_.enabled) {
        phase_ = Phase::kFinished;
        turn_.release();
        return port_.disconnect();
    }
    turn_.set_place(dialect().place());
    // Ahead of all that is there.
    if (auto lease = turn_.renewal(now)) retain(dialect().lease(), std::move(*lease), 0);
    const auto end = acknowledged_ + kSlice;
    std::size_t looked_at = 0;
    for (; !dirty_.empty() && looked_at < kBoardsAtOnce && acknowledged_ < end && port_.has_room();
         ++looked_at) {
        const auto name = *dirty_.begin();
        dirty_.erase(dirty_.begin());
        update(name, now);
        const auto record = records_.find(name);
        if (record != records_.end() && record->second.document_due) later_.insert(name);
    }
    if (!dirty_.empty()) {
        // Else an acknowledgement goes on.
        if (looked_at == kBoardsAtOnce && acknowledged_ + kSlice == end) port_.again();
        return;
    }
    if (gateway_due_) show_gateway();
    if (sessions_due_ && (sessions_at_ == Time{} || now - sessions_at_ >= kBetweenSessions) &&
        states_are_of_their_sessions())
        show_sessions(now);
}

void Exporter::update(const std::string& name, Time now) {
    auto present = port_.board(name);
    if (!present) return remove(name);
    const auto [found, added] = records_.try_emplace(name);
    auto& record = found->second;
    gateway_due_ = gateway_due_ || (added && dialect().lists_boards());
    online_ = online_ - (record.there ? 1U : 0U) + (present->there ? 1U : 0U);
    record.there = present->there;
    if (record.session != present->session) {
        record.session = std::move(present->session);
        sessions_due_ = true;
    }
    const bool changed = record.is_other(*present->board);
    if (changed) take(record, std::move(present->board));
    if (record.document_due) publish_document(record, now);
    if (changed || std::exchange(record.values_due, false)) all_values(record, now);
    auto state = dialect().state_of_board(present->there, present->state);
    if (record.state == state) return;
    record.state = std::move(state);
    retain(dialect().board_state(name), record.state);
}

std::string Exporter::state_topic(const Record& record, std::size_t index) const {
    const auto& board = *record.board;
    const auto count = board.properties.size();
    if (index < count) return dialect().state(board.board, board.properties[index]);
    return index == count ? dialect().error(board.board) : dialect().firmware(board.board);
}

void Exporter::take(Record& record, std::shared_ptr<const ExportedBoard> board) {
    std::map<std::string, PacedValue> old;
    for (std::size_t i = 0; i < record.states.size(); ++i)
        old[state_topic(record, i)] = std::move(record.states[i]);
    auto targets = std::exchange(record.targets, {});
    take_up(record, std::move(board),
            [this](const ExportedBoard& each) { return dialect().next_document(each, {}).text.size(); });
    record.document_due = true;
    record.states.clear();
    record.states.resize(record.board->properties.size() + more_slots());
    for (std::size_t i = 0; i < record.states.size(); ++i) {
        const auto topic = state_topic(record, i);
        std::erase(clear_, topic);  // it is wanted again
        if (const auto kept = old.find(topic); kept != old.end()) {
            record.states[i] = std::move(kept->second);
            old.erase(kept);
        }
        if (i >= record.board->properties.size()) continue;
        const auto target = dialect().target(record.board->board, record.board->properties[i]);
        std::erase(clear_, target);
        if (auto kept = targets.extract(target)) record.targets.insert(std::move(kept));
    }
    for (const auto& [topic, value] : old)
        if (!value.sent().empty()) clear_.push_back(topic);
    for (const auto& [topic, payload] : targets)
        clear_.push_back(topic);
}

void Exporter::publish_document(Record& record, Time now) {
    record.document_due = false;
    const auto topic = dialect().document_topic(record.board->board);
    std::erase(clear_, topic);  // it is wanted again
    auto document = dialect().next_document(*record.board, record.document);
    if (document.text != record.document) {
        if (record.document_at && now - *record.document_at < kBetweenDocuments) {
            record.document_due = true;
            return;
        }
        if (auto changing = dialect().changing(); !changing.empty()) {
            retain(dialect().board_state(record.board->board), changing);
            record.state = std::move(changing);
        }
        retain(topic, document.text);
        record.document = std::move(document.text);
        record.document_at = now;
    }
    record.document_due = !document.last;
}

void Exporter::remove(const std::string& name) {
    const auto found = records_.find(name);
    if (found == records_.end()) return;
    const auto& record = found->second;
    if (record.there) --online_;
    const auto document = dialect().document_topic(name);
    if (!document.empty() && dialect().last_cleared().empty()) retain(document, {});
    retain(dialect().board_state(name), {});
    for (std::size_t i = 0; i < record.states.size(); ++i)
        if (!record.states[i].sent().empty()) clear_.push_back(state_topic(record, i));
    for (const auto& [topic, payload] : record.targets)
        clear_.push_back(topic);
    if (!document.empty() && !dialect().last_cleared().empty()) clear_.push_back(document);
    records_.erase(found);
    sessions_due_ = true;
    gateway_due_ = gateway_due_ || dialect().lists_boards();
    clear_some();
}

bool Exporter::states_are_of_their_sessions() const {
    return std::none_of(pending_.begin(), pending_.end(), [this](const auto& each) {
        const auto found = records_.find(each.first);
        return found != records_.end() && each.second < found->second.states.size() &&
               found->second.states[each.second].is_outdated();
    });
}

/// Seldom: a gateway that starts meanwhile says of a board's older states that they are not known. Never
/// ahead of the states of these sessions: the next gateway would take older ones for theirs.
void Exporter::show_sessions(Time now) {
    sessions_due_ = false;
    sessions_at_ = now;
    auto sessions = json::object();
    for (const auto& [name, record] : records_)
        if (!record.session.empty()) sessions[name] = record.session;
    retain(dialect().sessions(), model::dump_json(sessions));
}

// --- values

void Exporter::publish_state(Record& record, std::size_t index) {
    const auto& text = record.states[index].sent();
    if (index < record.board->properties.size())
        publish_target(record, record.board->properties[index], text);
    retain(state_topic(record, index), text, dialect().state_qos());
}

/// Ahead of the value itself.
void Exporter::publish_target(Record& record, const Property& property, const std::string& payload) {
    auto topic = dialect().target(record.board->board, property);
    if (topic.empty() || (payload.empty() && !record.targets.contains(topic))) return;
    auto& target = record.targets[topic];
    if (target == payload) return;
    target = payload;
    if (payload.empty()) record.targets.erase(topic);
    retain(std::move(topic), payload, dialect().state_qos());
}

void Exporter::offer(Record& record, std::size_t index, std::string text, Time now) {
    auto& state = record.states[index];
    if (state.offer(std::move(text), now, between_, port_.has_room() && record.has_document()))
        publish_state(record, index);
    else if (state.waits())
        pending_.emplace(record.board->board, index);
}

void Exporter::value(std::string_view board, std::string_view service, std::string_view text, Time now) {
    if (phase_ != Phase::kActive) return;
    const auto found = records_.find(std::string(board));
    if (found == records_.end()) return;
    auto& record = found->second;
    const auto properties = record.by_service.find(service);
    if (properties == record.by_service.end()) return;
    std::uint64_t refused = 0;
    for (const auto& each : reported_values(*record.board, properties->second, text, refused))
        offer(record, each.property,
              dialect().state_text(record.board->properties[each.property], each.value), now);
    if (refused > 0) port_.refused(refused);
}

void Exporter::known(const std::string& board, const std::vector<std::string>& ids, Time now) {
    if (phase_ != Phase::kActive) return;
    const auto found = records_.find(board);
    if (found == records_.end()) return;
    const auto& properties = found->second.board->properties;
    for (std::size_t i = 0; i < properties.size(); ++i)
        if (properties[i].kind != Kind::kButton && is_one_of(properties[i], ids))
            show(found->second, i, port_.value(board, properties[i]), now);
}

void Exporter::acted(const std::string& board, const std::string& id, property::ButtonAct act) {
    const auto found = records_.find(board);
    if (phase_ != Phase::kActive || found == records_.end()) return;
    for (const auto& property : found->second.board->properties) {
        if (property.id != id) continue;
        auto said = dialect().act(board, property, act);
        if (!said) continue;
        mqtt::Message message{.topic = std::move(said->topic), .payload = std::move(said->text), .qos = 1};
        ++acknowledged_;
        port_.publish(std::move(message));
    }
}

void Exporter::all_values(Record& record, Time now) {
    const auto& board = *record.board;
    for (std::size_t i = 0; i < board.properties.size(); ++i)
        if (const auto& property = board.properties[i]; property.kind != Kind::kButton) {
            auto value = port_.value(board.board, property);
            // What the board reported before this gateway began is on the broker.
            if (value || !is_reported(property)) show(record, i, value, now);
        }
    if (!dialect().firmware(board.board).empty())
        offer(record, board.properties.size() + 1, dialect().firmware_text(board), now);
}

/// What is not known any more is said where something else was said before, or waits to be said.
void Exporter::show(Record& record, std::size_t index, const std::optional<json>& value, Time now) {
    const auto& property = record.board->properties[index];
    const auto& state = record.states[index];
    if ((value && !value->is_null()) || !state.sent().empty() || state.waits())
        offer(record, index, dialect().state_text(property, value.value_or(nullptr)), now);
}

// --- commands

Exporter::Record* Exporter::record_of(const std::string& id) {
    const auto found = records_.find(dialect().name_of(id));
    return found != records_.end() && dialect().id_of(found->first) == id ? &found->second : nullptr;
}

void Exporter::command(const Dialect::Command& which, const std::string& payload) {
    auto* record = record_of(which.board);
    const auto* property = record == nullptr ? nullptr : record->board->property(which.property);
    if (record == nullptr && dialect().has_neighbours()) return;
    if (property == nullptr) {
        const auto what = text::printable(which.board + "/" + which.property, kShownBytes);
        seldom_.say(what, std::string(dialect().title()) + " sets " + what + ", which is not there", now_);
        return;
    }
    const auto board = record->board->board;
    const auto value = dialect().value_of(*property, payload);
    if (!value) return failed(board, property->id, value.error());
    if (!record->there) return failed(board, property->id, property->name + ": the board is not there");
    if (!property->refused.empty()) return failed(board, property->id, property->refused);
    if (property->kind != Kind::kButton) publish_target(*record, *property, payload);
    for (const auto& request : requests_for(*property, *value))
        port_.command(board, request,
                      [this, board, id = property->id, name = property->name](const std::string& fault) {
                          if (!fault.empty()) failed(board, id, name + ": " + fault);
                      });
}

void Exporter::failed(const std::string& board, const std::string& id, const std::string& sentence) {
    seldom_.say(
        board + "/" + id,
        "board " + board + ": a command of " + std::string(dialect().title()) + " failed: " + sentence, now_);
    const auto found = records_.find(board);
    if (phase_ != Phase::kActive || found == records_.end() || dialect().read_only()) return;
    auto text = dialect().error_text(sentence);
    if (dialect().error_is_retained())
        return offer(found->second, found->second.board->properties.size(), std::move(text), now_);
    port_.publish(mqtt::Message{.topic = dialect().error(board), .payload = std::move(text)});
}

}  // namespace asip::gateway::exports
