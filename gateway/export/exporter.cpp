// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/exporter.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "asip/model/json.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

constexpr int kMarkDigits = 16;
constexpr Duration kAfterBirth = std::chrono::seconds(1);  // until Home Assistant has subscribed
constexpr std::string_view kOnline = "online";
constexpr std::string_view kOffline = "offline";

Lease::Holder self_of(const Exporter::Options& options) {
    return {options.gateway, 0, options.host, options.dialect.prefix};
}

Duration between(double per_second) {
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1 / per_second));
}

}  // namespace

Exporter::Exporter(Options options, Random random, Port port)
    : options_(std::move(options)),
      dialect_(options_.dialect),
      port_(std::move(port)),
      lease_(self_of(options_), random),
      random_(std::move(random)) {}

std::vector<std::string> Exporter::subscriptions() const {
    return {dialect_.lease(), dialect_.gateway_state()};
}

mqtt::Message Exporter::will() const {
    mqtt::Message message;
    message.topic = dialect_.gateway_state();
    message.payload = kOffline;
    message.qos = 1;
    message.retain = true;
    return message;
}

void Exporter::retain(std::string topic, std::string payload, int qos) {
    mqtt::Message message;
    message.topic = std::move(topic);
    message.payload = std::move(payload);
    message.qos = qos;
    message.retain = true;
    port_.publish(std::move(message));
}

// --- over the gateway's connection

void Exporter::subscribed(Time now) {
    lease_.subscribed(now);
}

void Exporter::message(const mqtt::Message& message, Time now) {
    if (message.topic == dialect_.lease()) {
        const bool mine = lease_.active();
        if (lease_.said(message.payload, message.retain, now) && mine && phase_ != Phase::kIdle)
            become_idle("another gateway exports to Home Assistant; this one waits");
    } else if (message.topic == dialect_.gateway_state()) {
        lease_.state(message.payload, now);
        // The broker says so of an earlier connection.
        if (phase_ == Phase::kActive && message.payload != kOnline)
            retain(dialect_.gateway_state(), std::string(kOnline));
    }
}

void Exporter::changed(const std::string& board, Time now) {
    if (phase_ != Phase::kActive) return;
    dirty_.insert(board);
    pump(now);
}

void Exporter::value(std::string_view board, std::string_view service, std::string_view json, bool set,
                     Time now) {
    if (phase_ != Phase::kActive) return;
    const auto found = records_.find(std::string(board));
    if (found != records_.end()) values_of(found->second, service, json, set, now);
}

// --- over the export's own connection

void Exporter::own_subscribed(Time now) {
    if (phase_ == Phase::kScanning && scan_.runs()) {
        // Behind all that is retained.
        mqtt::Message mark;
        mark.topic = dialect_.base() + "/$mark/" + scan_.mark();
        mark.payload = "1";
        port_.publish(std::move(mark));
    }
    if (phase_ != Phase::kConnecting) return;
    if (!lease_.active() && !lease_.may_claim(now)) return become_idle("");
    const auto holder = lease_.holder();
    retain(dialect_.lease(), lease_.claim(now), 0);
    if (!holder || holder->gateway != options_.gateway)
        port_.log(options_.enabled ? "exports boards to Home Assistant"
                                   : "clears what was exported to Home Assistant");
    begin_scan(now);
}

void Exporter::own_disconnected() {
    if (phase_ == Phase::kActive || phase_ == Phase::kScanning) phase_ = Phase::kConnecting;
    scan_.take_all();
    scan_until_.reset();
}

void Exporter::own_message(const mqtt::Message& message, Time now) {
    if (scan_.runs() && message.topic == dialect_.base() + "/$mark/" + scan_.mark()) return finish_scan(now);
    scan_.message(message);
    if (message.topic == dialect_.status()) {
        if (message.payload == kOnline && options_.enabled) scan_at_ = now + kAfterBirth;
        return;
    }
    if (message.retain || message.payload.empty() || phase_ != Phase::kActive) return;
    if (const auto which = dialect_.command_of(message.topic)) command(*which, message.payload);
}

void Exporter::begin_scan(Time now) {
    phase_ = Phase::kScanning;
    scan_at_.reset();
    scan_until_ = now + kScanLimit;
    scan_.begin(random_hex(random_, kMarkDigits));
    port_.subscribe(dialect_.base() + "/#");
    port_.subscribe(dialect_.documents());
    if (const auto& holder = lease_.holder(); holder && holder->prefix != options_.dialect.prefix)
        port_.subscribe(holder->prefix + "/device/+/config");
}

void Exporter::finish_scan(Time now) {
    scan_until_.reset();
    auto old = dialect_.options();
    old.prefix = lease_.holder() ? lease_.holder()->prefix : old.prefix;
    const HomeAssistant before(old);
    port_.unsubscribe(dialect_.base() + "/#");
    port_.unsubscribe(dialect_.documents());
    if (old.prefix != options_.dialect.prefix) port_.unsubscribe(before.documents());
    if (!scan_.complete())
        port_.log("too much is retained below " + dialect_.base() + " to be looked through");
    const auto found = scan_.take_all();
    const auto on_bus = [&](const std::string& topic) {
        const auto each = found.find(topic);
        return each == found.end() ? std::string() : each->second;
    };

    std::set<std::string> wanted;
    const auto boards = options_.enabled ? port_.boards() : std::vector<std::string>();
    for (const auto& [name, record] : records_)
        dirty_.insert(name);  // it may have been forgotten meanwhile
    for (const auto& name : boards) {
        auto present = port_.board(name);
        if (!present) continue;
        dirty_.insert(name);
        auto& record = records_[name];
        wanted.insert(dialect_.document_topic(name));
        wanted.insert(dialect_.board_state(name));
        record.document = on_bus(dialect_.document_topic(name));
        record.on_bus = HomeAssistant::components_of(record.document);
        const auto state = on_bus(dialect_.board_state(name));
        record.there = state.empty() ? std::nullopt : std::optional(state == kOnline);
        if (record.board.board.empty()) take(record, std::move(present->board));
        for (std::size_t i = 0; i < record.states.size(); ++i) {
            const auto topic = state_topic(record, i);
            wanted.insert(topic);
            auto text = record.states[i].sent();
            record.states[i].adopt(on_bus(topic));
            if (!text.empty()) offer(record, i, std::move(text), now);
        }
        all_values(record, now);
    }
    if (options_.enabled) wanted.insert({dialect_.lease(), dialect_.gateway_state()});
    for (const auto& [topic, payload] : found) {
        const bool ours = topic.starts_with(dialect_.base() + "/") || dialect_.is_document(topic) ||
                          before.is_document(topic);
        if (!ours || wanted.contains(topic) || topic == dialect_.lease()) continue;
        clear_.push_back(topic);
    }
    phase_ = Phase::kActive;
    if (options_.enabled) {
        port_.subscribe(dialect_.status());
        if (!options_.dialect.read_only) port_.subscribe(dialect_.commands());
        retain(dialect_.gateway_state(), std::string(kOnline));
    } else {
        clear_.push_back(dialect_.lease());  // last: until then the next start knows of the rest
    }
    pump(now);
}

void Exporter::become_idle(const char* why) {
    phase_ = Phase::kIdle;
    lease_.release();
    records_.clear();
    dirty_.clear();
    clear_.clear();
    pending_.clear();
    scan_.take_all();
    scan_until_.reset();
    scan_at_.reset();
    if (*why != '\0') port_.log(why);
    port_.disconnect();
}

bool Exporter::may_clear(Time now) const {
    const auto& holder = lease_.holder();
    return lease_.may_claim(now) && (options_.clear_all || (holder && holder->host == options_.host));
}

void Exporter::tick(Time now) {
    now_ = now;
    if (phase_ == Phase::kIdle && port_.ready() &&
        (options_.enabled ? lease_.may_claim(now) : may_clear(now))) {
        phase_ = Phase::kConnecting;
        port_.connect();
        return;
    }
    if (phase_ == Phase::kConnecting && !lease_.active() && lease_.held(now)) return become_idle("");
    if (phase_ == Phase::kScanning && scan_until_ && now >= *scan_until_) finish_scan(now);
    if (phase_ == Phase::kScanning || phase_ == Phase::kActive)
        if (auto lease = lease_.renewal(now)) retain(dialect_.lease(), std::move(*lease), 0);
    if (phase_ != Phase::kActive) return;
    if (scan_at_ && now >= *scan_at_) return begin_scan(now);
    for (auto each = pending_.begin(); each != pending_.end();) {
        const auto found = records_.find(each->first);
        const bool there = found != records_.end() && each->second < found->second.states.size();
        if (there &&
            found->second.states[each->second].take(now, between(options_.per_second), port_.has_room()))
            publish_state(found->second, each->second);
        if (!there || !found->second.states[each->second].waits())
            each = pending_.erase(each);
        else
            ++each;
    }
    pump(now);
}

void Exporter::leave() {
    if (phase_ == Phase::kActive || phase_ == Phase::kScanning)
        if (options_.enabled) retain(dialect_.gateway_state(), std::string(kOffline));
    phase_ = Phase::kFinished;
    records_.clear();
}

// --- boards

void Exporter::clear_some() {
    while (!clear_.empty() && port_.has_room()) {
        retain(std::move(clear_.front()), {});
        clear_.pop_front();
    }
}

void Exporter::pump(Time now) {
    clear_some();
    if (!clear_.empty()) return;
    if (!options_.enabled) {
        phase_ = Phase::kFinished;
        lease_.release();
        return port_.disconnect();
    }
    lease_.set_prefix(options_.dialect.prefix);
    std::set<std::string> later;
    while (!dirty_.empty() && port_.has_room()) {
        const auto name = *dirty_.begin();
        dirty_.erase(dirty_.begin());
        update(name, now);
        const auto record = records_.find(name);
        if (record != records_.end() && record->second.document_due) later.insert(name);
    }
    dirty_.merge(later);
}

void Exporter::update(const std::string& name, Time now) {
    auto present = port_.board(name);
    if (!present) return remove(name);
    auto& record = records_[name];
    const bool changed = !(record.board == present->board);
    if (changed) take(record, std::move(present->board));
    publish_document(record, now);
    if (record.there != present->there) {
        record.there = present->there;
        retain(dialect_.board_state(name), std::string(present->there ? kOnline : kOffline));
    }
    if (changed) all_values(record, now);
}

std::string Exporter::state_topic(const Record& record, std::size_t index) const {
    const auto& entities = record.board.entities;
    return dialect_.state(record.board.board, index < entities.size() ? std::string_view(entities[index].id)
                                                                      : HomeAssistant::kLastError);
}

void Exporter::take(Record& record, ExportedBoard board) {
    std::map<std::string, PacedValue> old;
    for (std::size_t i = 0; i < record.states.size(); ++i)
        old[state_topic(record, i)] = std::move(record.states[i]);
    record.board = std::move(board);
    record.states.clear();
    record.states.resize(record.board.entities.size() + 1);
    record.by_service.clear();
    for (std::size_t i = 0; i < record.states.size(); ++i) {
        std::erase(clear_, state_topic(record, i));  // it is wanted again
        if (const auto kept = old.find(state_topic(record, i)); kept != old.end()) {
            record.states[i] = std::move(kept->second);
            old.erase(kept);
        }
        if (i == record.board.entities.size()) break;
        const auto& entity = record.board.entities[i];
        if (entity.kind == EntityKind::kButton) continue;
        const auto& call = entity.write ? entity.write : entity.color;
        record.by_service[entity.read ? entity.read->service : call->service].push_back(i);
    }
    for (const auto& [topic, value] : old)
        if (!value.sent().empty()) clear_.push_back(topic);
    std::vector<bus::Demander::Want> wants;
    for (const auto& [service, entities] : record.by_service)
        wants.push_back(port_.want(record.board.board, service, options_.per_second));
    record.wants = std::move(wants);
}

// One that leaves components out does not remove them: they are named by their platform alone first.
void Exporter::publish_document(Record& record, Time now) {
    record.document_due = false;
    const auto& board = record.board;
    const auto removing = dialect_.removing_document(board, record.on_bus);
    const auto document = removing.empty() ? dialect_.document(board) : removing;
    const auto wanted = dialect_.components(board);
    if (document != record.document) {
        if (record.document_at && now - *record.document_at < kBetweenDocuments) {
            record.document_due = true;
            return;
        }
        retain(dialect_.document_topic(board.board), document);
        record.document = document;
        record.document_at = now;
    }
    if (removing.empty()) {
        record.on_bus = wanted;
        return;
    }
    std::erase_if(record.on_bus, [&](const auto& each) {
        const auto found = wanted.find(each.first);
        return found == wanted.end() || found->second != each.second;
    });
    record.document_due = true;
    if (!record.document_at) record.document_at = now;
}

void Exporter::remove(const std::string& name) {
    const auto found = records_.find(name);
    if (found == records_.end()) return;
    const auto& record = found->second;
    retain(dialect_.document_topic(name), {});
    retain(dialect_.board_state(name), {});
    for (std::size_t i = 0; i < record.states.size(); ++i)
        if (!record.states[i].sent().empty()) clear_.push_back(state_topic(record, i));
    records_.erase(found);
    clear_some();
}

// --- values

void Exporter::publish_state(const Record& record, std::size_t index) {
    retain(state_topic(record, index), record.states[index].sent(), 0);
}

void Exporter::offer(Record& record, std::size_t index, std::string text, Time now) {
    auto& state = record.states[index];
    if (state.offer(std::move(text), now, between(options_.per_second), port_.has_room()))
        publish_state(record, index);
    else if (state.waits())
        pending_.emplace(record.board.board, index);
}

void Exporter::all_values(Record& record, Time now) {
    for (const auto& [service, entities] : record.by_service)
        port_.values(record.board.board, service,
                     [&](std::string_view json, bool set) { values_of(record, service, json, set, now); });
}

void Exporter::values_of(Record& record, std::string_view service, std::string_view text, bool set,
                         Time now) {
    const auto found = record.by_service.find(service);
    if (found == record.by_service.end()) return;
    json value;
    if (!text.empty()) {
        auto parsed = model::parse_json(text);
        if (!parsed) return;
        value = std::move(*parsed);
    }
    for (const auto index : found->second) {
        const auto& entity = record.board.entities[index];
        if (entity.read.has_value() == set) continue;
        const auto shown = set ? value_set(entity, value) : value_in(entity, value);
        // What is not known any more is said where something else was said before.
        if (shown || (set && !record.states[index].sent().empty()))
            offer(record, index, dialect_.state_text(entity, shown.value_or(nullptr)), now);
    }
}

// --- commands

void Exporter::command(const HomeAssistant::Command& which, const std::string& payload) {
    const auto found = records_.find(which.board);
    const auto* entity = found == records_.end() ? nullptr : found->second.board.entity(which.entity);
    if (entity == nullptr) {
        port_.log("Home Assistant sets " + which.board + "/" + which.entity + ", which is not there");
        return;
    }
    const auto value = dialect_.value_of(*entity, payload);
    if (!value) return failed(which.board, value.error());
    if (!found->second.there.value_or(false))
        return failed(which.board, entity->name + ": the board is not there");
    for (const auto& request : requests_for(*entity, *value))
        port_.command(which.board, request,
                      [this, board = which.board, name = entity->name](const std::string& fault) {
                          if (!fault.empty()) failed(board, name + ": " + fault);
                      });
}

void Exporter::failed(const std::string& board, const std::string& sentence) {
    port_.log("board " + board + ": a command of Home Assistant failed: " + sentence);
    const auto found = records_.find(board);
    if (phase_ != Phase::kActive || found == records_.end() || options_.dialect.read_only) return;
    offer(found->second, found->second.board.entities.size(), HomeAssistant::cut(sentence), now_);
}

}  // namespace asip::gateway::exports
