// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/exporter.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/model/json.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxSessionsBytes = std::size_t{8} << 20;
constexpr int kMarkDigits = 16;
constexpr Duration kAfterBirth = std::chrono::seconds(1);  // until the other system has subscribed

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

Exporter::Exporter(Options options, Random random, Port port)
    : BoardExport(options, options.dialect->place(), random, std::move(port)),
      dialect_(std::move(options.dialect)),
      random_(std::move(random)) {}

std::vector<std::string> Exporter::subscriptions() const {
    return {dialect().lease(), dialect().gateway_state()};
}

std::vector<std::string> Exporter::own_subscriptions() const {
    return {dialect().status().empty() ? dialect().lease() : dialect().status()};
}

std::optional<mqtt::Message> Exporter::will() const {
    return mqtt::Message{
        .topic = dialect().gateway_state(), .payload = dialect().lost(), .qos = 1, .retain = true};
}

void Exporter::retain(std::string topic, std::string payload, int qos) {
    if (qos > 0) ++acknowledged_;
    BoardExport::retain(std::move(topic), std::move(payload), qos);
}

// --- over the gateway's connection

void Exporter::message(const mqtt::Message& message, Time now) {
    if (message.topic == dialect().lease()) {
        lease_said(message, now);
    } else if (message.topic == dialect().gateway_state()) {
        const auto changing = dialect().changing();
        if (!changing.empty() && message.payload == changing) return;
        const bool online = message.payload == dialect().online();
        turn_.state(online ? "online" : "offline", now);
        // The broker says so of an earlier connection.
        if (phase_ != Phase::kActive || online || !options_.enabled) return;
        gateway_due_ = true;
        if (changing.empty())
            show_gateway();
        else
            pump(now);
    }
}

// --- over the export's own connection

void Exporter::own_subscribed(Time now) {
    if (phase_ == Phase::kPreparing && scan_.runs()) {
        // Behind all that is retained: a message of QoS 0 would overtake those of QoS 1 that wait.
        port_.publish(mqtt::Message{.topic = mark(), .payload = "1", .qos = 1});
    }
    if (phase_ != Phase::kConnecting) return;
    if (claim((options_.enabled ? "exports boards to " : "clears what was exported to ") +
                  std::string(dialect().title()),
              now))
        begin_scan(now);
}

void Exporter::own_disconnected() {
    if (phase_ == Phase::kActive || phase_ == Phase::kPreparing) phase_ = Phase::kConnecting;
    scan_.take_all();
    scan_until_.reset();
}

void Exporter::own_message(const mqtt::Message& message, Time now) {
    if (scan_.runs() && message.topic == mark()) return finish_scan(now);
    scan_.message(message);
    if (!message.topic.empty() && message.topic == dialect().status()) {
        if (message.payload == "online" && options_.enabled) scan_at_ = now + kAfterBirth;
        return;
    }
    if (message.retain || phase_ != Phase::kActive) return;
    // In the order of the broker: what a gateway empties that took over is no longer ours.
    if (message.topic == dialect().lease()) return this->message(message, now);
    if (const auto which = dialect().command_of(message.topic)) return command(*which, message.payload);
    if (!message.payload.empty() || !options_.enabled) return;
    if (emptied_.size() < kMaxEmptied)
        emptied_.insert(message.topic);
    else
        scan_at_ = now + kPutBack;
    if (!put_back_at_) put_back_at_ = now + kPutBack;
}

void Exporter::sent(Time now) {
    if (phase_ == Phase::kActive && !(dirty_.empty() && clear_.empty())) pump(now);
}

void Exporter::begin_scan(Time now) {
    phase_ = Phase::kPreparing;
    scan_at_.reset();
    scan_until_ = now + kScanLimit;
    scan_.begin(random_hex(random_, kMarkDigits));
    port_.subscribe(dialect().base() + "/#");
    for (const auto& filter : filters(dialect(), turn_.holder()))
        port_.subscribe(filter);
}

/// What the broker keeps of a board that is there.
void Exporter::take_retained(Record& record, Present present, const Dialect::Retained& found, bool same,
                             Time now) {
    const auto& name = present.board->board;
    record.document = on_bus(found, dialect().document_topic(name));
    record.document_due = record.values_due = true;
    record.state = on_bus(found, dialect().board_state(name));
    record.session = std::move(present.session);
    if (!record.board) take(record, present.board);
    record.targets.clear();
    for (std::size_t i = 0; i < record.states.size(); ++i) {
        auto text = record.states[i].sent();
        record.states[i].adopt(on_bus(found, state_topic(record, i)));
        const bool older = !same && !(text.empty() && record.states[i].sent().empty());
        if (older)
            text = i < record.board->properties.size()
                       ? dialect().state_text(record.board->properties[i], nullptr)
                       : std::string();
        // Behind the document.
        if (older || !text.empty()) record.states[i].offer(std::move(text), now, between_, false);
        if (record.states[i].waits()) pending_.emplace(name, i);
        if (i >= record.board->properties.size()) continue;
        const auto target = dialect().target(name, record.board->properties[i]);
        if (auto each = found.find(target); each != found.end()) record.targets[target] = each->second;
    }
}

void Exporter::begin_to_show(const Dialect::Retained& found) {
    if (!dialect().status().empty()) port_.subscribe(dialect().status());
    if (!dialect().read_only()) port_.subscribe(dialect().commands());
    for (const auto& filter : dialect().watched())
        port_.watch(filter);
    gateway_document_ = on_bus(found, dialect().gateway_document_topic());
    standing_ = on_bus(found, dialect().standing_topic());
    if (dialect().changing().empty())
        show_gateway();
    else
        retain(dialect().gateway_state(), dialect().changing());
}

void Exporter::finish_scan(Time now) {
    scan_until_.reset();
    const auto holder = turn_.holder();
    port_.unsubscribe(dialect().base() + "/#");
    for (const auto& filter : filters(dialect(), holder))
        port_.unsubscribe(filter);
    if (!scan_.complete())
        port_.log("too much is retained below " + dialect().base() + " to be looked through");
    const auto found = scan_.take_all();

    std::set<std::string> wanted;
    for (const auto& [name, record] : records_)
        dirty_.insert(name);  // it may have been forgotten meanwhile
    const auto sessions = sessions_in(found, dialect().sessions());
    sessions_due_ = options_.enabled;
    const auto boards = options_.enabled ? port_.boards() : std::vector<std::string>();
    for (const auto& name : boards) {
        auto present = port_.board(name);
        if (!present) continue;
        dirty_.insert(name);
        auto& record = records_[name];
        bool same = record.session == present->session;
        if (const auto known = sessions.find(name); !record.board)
            same = known != sessions.end() && known->second == present->session;
        take_retained(record, std::move(*present), found, same, now);
        wanted.insert({dialect().document_topic(name), dialect().board_state(name)});
        for (std::size_t i = 0; i < record.states.size(); ++i)
            wanted.insert(state_topic(record, i));
        for (const auto& [topic, payload] : record.targets)
            wanted.insert(topic);
    }
    if (options_.enabled)
        wanted.insert({dialect().lease(), dialect().sessions(), dialect().gateway_state(),
                       dialect().gateway_document_topic(), dialect().standing_topic()});
    std::set<std::string> ours;
    for (const auto& place : places(dialect(), holder))
        for (auto& topic : dialect().ours(found, place))
            ours.insert(std::move(topic));
    for (const auto& topic : ours)
        if (!wanted.contains(topic) && topic != dialect().lease()) clear_.push_back(topic);
    if (const auto end = dialect().last_cleared(); !end.empty())
        std::stable_partition(clear_.begin(), clear_.end(),
                              [&](const std::string& topic) { return !topic.ends_with(end); });
    phase_ = Phase::kActive;
    gateway_due_ = true;
    if (options_.enabled)
        begin_to_show(found);
    else
        clear_.push_back(dialect().lease());  // last: until then the next start knows of the rest
    pump(now);
}

void Exporter::become_idle(const std::string& why) {
    phase_ = Phase::kIdle;
    turn_.release();
    records_.clear();
    online_ = 0;
    dirty_.clear();
    later_.clear();
    clear_.clear();
    emptied_.clear();
    put_back_at_.reset();
    pending_.clear();
    scan_.take_all();
    scan_until_.reset();
    scan_at_.reset();
    sessions_at_ = {};
    if (!why.empty()) port_.log(why);
    port_.disconnect();
}

void Exporter::connect() {
    phase_ = Phase::kConnecting;
    port_.connect();
}

void Exporter::tick(Time now) {
    if (phase_ == Phase::kPreparing && scan_until_ && now >= *scan_until_) finish_scan(now);
    if (!keep_turn(now)) return;
    if (scan_at_ && now >= *scan_at_) return begin_scan(now);
    if (put_back_at_ && now >= *put_back_at_) put_back(now);
    for (auto each = pending_.begin(); each != pending_.end();) {
        const auto found = records_.find(each->first);
        const bool there = found != records_.end() && each->second < found->second.states.size();
        if (there && found->second.states[each->second].take(
                         now, between_, port_.has_room() && found->second.has_document()))
            publish_state(found->second, each->second);
        if (!there || !found->second.states[each->second].waits())
            each = pending_.erase(each);
        else
            ++each;
    }
    dirty_.merge(later_);
    pump(now);
    show_standing();
}

void Exporter::leave() {
    if (phase_ == Phase::kActive && sessions_due_ && options_.enabled && states_are_of_their_sessions())
        show_sessions(now_);
    if (phase_ == Phase::kActive || phase_ == Phase::kPreparing)
        if (options_.enabled) retain(dialect().gateway_state(), dialect().leaving());
    phase_ = Phase::kFinished;
    records_.clear();
}

}  // namespace asip::gateway::exports
