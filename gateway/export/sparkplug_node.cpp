// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/sparkplug_node.hpp"

#include <utility>

#include "asip/text/printable.hpp"

namespace asip::gateway::exports {
namespace {

constexpr unsigned kNumbers = 256;  // of bdSeq and seq
constexpr std::string_view kOnline = "online";
constexpr std::string_view kOffline = "offline";
constexpr std::size_t kShownTopic = 120;
constexpr double kClocksDiffer = 60'000;  // in milliseconds

}  // namespace

SparkplugNode::SparkplugNode(Options options, Random random, Port port)
    : BoardExport(options, options.dialect.group + "/" + options.dialect.edge, std::move(random),
                  std::move(port)),
      names_(std::move(options.dialect)),
      dialect_(names_) {}

std::vector<std::string> SparkplugNode::subscriptions() const {
    std::vector<std::string> result{dialect_.lease(), dialect_.state()};
    if (options_.enabled) result.push_back(dialect_.topic("NDEATH"));
    return result;
}

std::vector<std::string> SparkplugNode::own_subscriptions() const {
    if (!options_.enabled) return {dialect_.lease()};
    std::vector<std::string> result{dialect_.topic("NCMD")};
    if (!names_.read_only) result.push_back(dialect_.topic("DCMD", "+"));
    if (!names_.host.empty()) result.push_back(dialect_.host_state());
    return result;
}

std::optional<mqtt::Message> SparkplugNode::will() const {
    return options_.enabled ? std::optional(death_of(next_bd_seq_)) : std::nullopt;
}

mqtt::Message SparkplugNode::death_of(unsigned bd_seq) const {
    sparkplug::Payload payload;
    payload.timestamp = time_ms();
    payload.metrics.push_back(Sparkplug::bd_seq(bd_seq, *payload.timestamp));
    return mqtt::Message{.topic = dialect_.topic("NDEATH"), .payload = sparkplug::write(payload), .qos = 1};
}

/// With the next number.
void SparkplugNode::say(const std::string& topic, sparkplug::Payload payload) {
    payload.timestamp = time_ms();
    payload.seq = seq_;
    seq_ = (seq_ + 1) % kNumbers;
    port_.publish(mqtt::Message{.topic = topic, .payload = sparkplug::write(payload)});
}

/// The first, and then ever more seldom: what others send must not fill the log.
void SparkplugNode::log_seldom(std::uint64_t count, const std::string& sentence) {
    if ((count & (count - 1)) == 0) port_.log(sentence + " (" + std::to_string(count) + " so far)");
}

std::optional<sparkplug::Payload> SparkplugNode::read(const mqtt::Message& message) {
    auto payload = sparkplug::read(message.payload);
    if (payload) return std::move(*payload);
    log_seldom(++counters_.bad, "what came on " + text::printable(message.topic, kShownTopic) +
                                    " is dropped: " + payload.error());
    return std::nullopt;
}

// --- over the gateway's connection

void SparkplugNode::message(const mqtt::Message& message, Time now) {
    if (message.topic == dialect_.lease()) {
        lease_said(message, now);
    } else if (message.topic == dialect_.state()) {
        turn_.state(message.payload == kOnline ? kOnline : kOffline, now);
        // Emptied, or said of an earlier holder.
        if (phase_ == Phase::kActive && message.payload != kOnline)
            retain(dialect_.state(), std::string(kOnline), 0);
    } else if (message.topic == dialect_.topic("NDEATH") && !message.retain) {
        const auto payload = sparkplug::read(message.payload);
        if (!payload || payload->metrics.empty()) return;
        if (!turn_.active()) return turn_.state(kOffline, now);
        // Hosts believe that this node is gone.
        if (phase_ == Phase::kActive &&
            payload->metrics.front().value == sparkplug::Value(std::int64_t{bd_seq_}))
            births_due_ = born_at_.value_or(now) + kBetweenBirths;
    }
}

// --- over the export's own connection

void SparkplugNode::connect() {
    if (phase_ == Phase::kIdle) next_bd_seq_ = static_cast<unsigned>((turn_.next_term() - 1) % kNumbers);
    phase_ = Phase::kConnecting;
    host_online_ = false;
    host_time_ = 0;
    port_.connect();
}

void SparkplugNode::own_connected() {
    bd_seq_ = std::exchange(next_bd_seq_, (next_bd_seq_ + 1) % kNumbers);
}

void SparkplugNode::own_subscribed(Time now) {
    now_ = now;
    if (phase_ != Phase::kConnecting) return;
    if (!options_.enabled && (turn_.active() || turn_.may_claim(now))) return clear();
    if (!claim("exports boards to Sparkplug as " + names_.group + "/" + names_.edge, now)) return;
    phase_ = Phase::kPreparing;
    if (names_.host.empty() || host_online_) births(now);
}

void SparkplugNode::own_disconnected() {
    if (phase_ == Phase::kActive || phase_ == Phase::kPreparing) phase_ = Phase::kConnecting;
    host_online_ = false;
    host_time_ = 0;
    pending_.clear();
    births_due_.reset();
    port_.discard();  // it has numbers of the session that is over
}

/// Nothing is left of an export that has ended.
void SparkplugNode::clear() {
    retain(dialect_.state(), {}, 0);
    retain(dialect_.lease(), {}, 0);
    phase_ = Phase::kFinished;
    port_.disconnect();
}

void SparkplugNode::births(Time now) {
    phase_ = Phase::kActive;
    ++counters_.births;
    born_at_ = now;
    births_due_.reset();
    seq_ = 0;
    next_alias_ = 1;
    say(dialect_.topic("NBIRTH"), {{}, dialect_.node_metrics(bd_seq_, time_ms()), {}});
    retain(dialect_.state(), std::string(kOnline), 0);
    for (auto& [name, record] : records_) {
        record.born = false;
        dirty_.insert(name);  // it may have been forgotten meanwhile
    }
    for (auto& name : port_.boards())
        dirty_.insert(std::move(name));
    pump(now);
}

/// `said`: hosts are told, by this connection, and the next one has another number.
void SparkplugNode::end_session(bool said) {
    if (said && phase_ == Phase::kActive) port_.publish(death_of(bd_seq_));
    port_.disconnect();
    records_.clear();
    dirty_.clear();
    pending_.clear();
    births_due_.reset();
}

void SparkplugNode::become_idle(const std::string& why) {
    end_session(false);
    phase_ = Phase::kIdle;
    turn_.release();
    if (!why.empty()) port_.log(why);
}

void SparkplugNode::own_message(const mqtt::Message& message, Time now) {
    now_ = now;
    if (!names_.host.empty() && message.topic == dialect_.host_state()) return host_said(message, now);
    if (message.retain || phase_ != Phase::kActive) return;
    if (message.topic == dialect_.topic("NCMD")) return node_command(message, now);
    if (const auto board = dialect_.board_of(message.topic)) board_command(*board, message);
}

void SparkplugNode::host_said(const mqtt::Message& message, Time now) {
    const auto said = Sparkplug::host_state_from(message.payload);
    if (!said) {
        if (!message.payload.empty())
            log_seldom(++counters_.bad, "the state of host " + names_.host + " cannot be read");
        return;
    }
    // Anybody may have retained such a message, and a time of the future would be the latest for ever.
    const bool has_time = said->timestamp <= static_cast<double>(port_.wall_ms()) + kClocksDiffer;
    if (has_time && said->timestamp < host_time_) return;  // of an earlier connection of that host
    if (has_time && !message.retain) host_time_ = said->timestamp;
    if (std::exchange(host_online_, said->online) == said->online) return;
    if (said->online && phase_ == Phase::kPreparing) return births(now);
    if (said->online || phase_ != Phase::kActive) return;
    port_.log("the Sparkplug host " + names_.host + " is gone; boards are born again when it is back");
    end_session(true);
    connect();
}

void SparkplugNode::tick(Time now) {
    if (!keep_turn(now)) return;
    if (births_due_ && now >= *births_due_) return births(now);
    std::map<std::string, std::vector<std::size_t>> due;
    for (auto each = pending_.begin(); each != pending_.end();) {
        const auto found = records_.find(each->first);
        if (found == records_.end() || !found->second.born || each->second >= found->second.states.size()) {
            each = pending_.erase(each);
            continue;
        }
        auto& state = found->second.states[each->second];
        const bool room = port_.has_room();
        const bool fault = state.fault_due && room && (!state.fault_at || now - *state.fault_at >= between_);
        if (state.value.take(now, between_, room) || fault) due[each->first].push_back(each->second);
        if (!state.value.waits() && (!state.fault_due || fault))
            each = pending_.erase(each);
        else
            ++each;
    }
    for (const auto& [name, properties] : due)
        publish_data(records_[name], properties);
    pump(now);
}

void SparkplugNode::leave() {
    if (phase_ == Phase::kActive) port_.publish(death_of(bd_seq_));
    if (phase_ == Phase::kActive || phase_ == Phase::kPreparing)
        retain(dialect_.state(), std::string(kOffline), 0);
    phase_ = Phase::kFinished;
    records_.clear();
}

}  // namespace asip::gateway::exports
