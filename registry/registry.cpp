// SPDX-License-Identifier: Apache-2.0
#include "registry/registry.hpp"

#include "asip/bus/registry/query.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/program/log.hpp"

namespace asip::registry {
namespace {

namespace log = program::log;
using bus::TopicKind;

// After a pause as long as this, messages wait that are older than the leases to be judged.
constexpr Duration kStall = std::chrono::seconds(2);
// Another registry with the same id that answers within this time of the start was there first.
constexpr Duration kStartTime = std::chrono::seconds(5);
constexpr Duration kIdentityLogInterval = std::chrono::minutes(1);
constexpr std::size_t kMaxDeniedLogged = 16;  // topics; answers go wherever a requester wants
constexpr Duration kStateRepeat = std::chrono::seconds(1);

}  // namespace

Registry::Registry(const RegistryOptions& options, model::ModelSet models, Random random, Port port,
                   HistoryKeeper* history, Instant now, ValueKeeper* values)
    : topics_(options.topic_root),
      id_(options.id),
      user_(options.mqtt.user),
      notifies_(!options.notify.empty()),
      has_user_(options.mqtt.has_user()),
      random_(std::move(random)),
      port_(std::move(port)),
      history_(history),
      values_(values),
      now_(now),
      run_(random_hex(random_, 8)),
      replies_(topics_, user_, "registry-" + random_hex(random_, 16)),
      catalogue_(catalogue_options(options, models)),
      feed_(id_),
      first_state_(
          topics_, replies_.to(topics_.registry_query(id_)),
          [this](mqtt::Message message) { port_.publish(std::move(message)); }, [this] { complete(); }),
      statistics_(options.stats_interval, now.time),
      identity_(topics_, id_, run_, replies_.to(topics_.registry_query(id_)), random_hex(random_, 16)),
      tidier_(topics_, port_,
              [this](const std::string& board) {
                  const auto item = catalogue_.board(board, now_);
                  return item && item->state != "lost" && item->state != "offline";
              }),
      names_only_(topics_, port_),
      queries_(id_, query_dependencies(std::move(models))),
      endpoint_(
          queries_,
          [this](mqtt::Message answer) {
              ++statistics_.counts.queries;
              (port_.answer ? port_.answer : port_.publish)(std::move(answer));
          },
          [this](const std::string& topic) { return may_answer(topic); }, port_.takes_answers) {
    catalogue_.suspend();
    if (values_ != nullptr) choice_.emplace(value_choice(options));
    if (has_user_) endpoint_.set_forget_topic(bus::forget_topic(topics_, id_));
}

Catalogue::Options Registry::catalogue_options(const RegistryOptions& options,
                                               const model::ModelSet& models) {
    Catalogue::Options result;
    result.forget_after = options.forget_after;
    result.max_boards = options.max_boards;
    result.units_of = [models](std::string_view reference) { return model::units_of(models, reference); };
    result.hash_seed = random_();
    if (history_ != nullptr)
        result.remembered = [this](std::string_view board) { return history_->remembered(board, now_); };
    return result;
}

Queries::Dependencies Registry::query_dependencies(model::ModelSet models) {
    Queries::Dependencies result{catalogue_, [this] { return now_; }, [this] { return feed_.seq(); }, {}, {}};
    result.models = std::move(models);
    result.forgotten = [this](const std::vector<Event>& events) { handle(events, true); };
    if (history_ != nullptr) {
        result.history = [this](bus::Query query, Queries::Done done) {
            history_->find(std::move(query), std::move(done));
        };
    }
    if (values_ != nullptr) {
        result.values = [this](bus::Query query, Queries::Done done) {
            values_->find(std::move(query), now_, std::move(done));
        };
    }
    return result;
}

ValueChoice Registry::value_choice(const RegistryOptions& options) {
    ValueChoice::Handlers handlers;
    handlers.set = [this](const PropertyKey& key, double value) { values_->set(key, value, now_); };
    handlers.drop = [this](const PropertyKey& key) { values_->drop(key, now_); };
    handlers.look = [this](const std::string& board) { return catalogue_.board(board, now_); };
    auto port = port_;
    if (port_.subscribe_values) {
        port.subscribe = port_.subscribe_values;
        port.unsubscribe = port_.unsubscribe_values;
    }
    return {topics_,
            {options.values, options.values_demand},
            std::move(port),
            bus::Demander(topics_, user_, "registry-" + random_hex(random_, 16), random_),
            std::move(handlers)};
}

std::vector<std::string> Registry::board_names() const {
    std::vector<std::string> names;
    catalogue_.for_each([&names](std::string_view board, model::BoardState, model::StateReason) {
        names.emplace_back(board);
    });
    return names;
}

std::vector<Registry::Subscription> Registry::subscriptions() const {
    // QoS 0 for announcements: they repeat, and brokers hold fewer messages at QoS 1 than they retain. Only
    // what is read: what anybody may retain below the service bus, such as demands, would fill our queue.
    std::vector<Subscription> result{
        {topics_.board_names(), 0, true},       {topics_.service_names("+"), 0, true},
        {topics_.state("+"), 0, true},          {topics_.description("+"), 0, true},
        {topics_.commands("+"), 0, false},      {topics_.registry_stats(id_), 0, true},
        {topics_.registry_state(id_), 0, true}, {identity_.reply_topic(), 1, false}};
    if (choice_) result.push_back({choice_->dashboards(), 0, true});
    return result;
}

std::vector<std::string> Registry::questions() const {
    return {topics_.any_registry_query(), topics_.registry_query(id_), bus::forget_topic(topics_),
            bus::forget_topic(topics_, id_)};
}

mqtt::Message Registry::state(std::string word) const {
    return mqtt::Message{
        .topic = topics_.registry_state(id_), .payload = std::move(word), .qos = 1, .retain = true};
}

mqtt::Message Registry::will() const {
    return state("lost");
}

void Registry::connected(std::size_t max_packet_bytes, Instant now) {
    now_ = now;
    connected_ = true;
    last_tick_ = now.time;
    catalogue_.resume(now.time);
    stray_answer_logged_ = false;
    feed_.begin(run_ + "-" + std::to_string(++statistics_.counts.connections));
    queries_.set_epoch(feed_.epoch());
    queries_.set_settling(true);
    endpoint_.set_max_bytes(max_packet_bytes);
    if (history_ != nullptr) history_->begin_reading();
    if (choice_) choice_->connected(now.time);
    port_.publish(identity_.probe());
    first_state_.begin(random_hex(random_, 16), now.time);
    // This word goes last, since a broker that cannot store it reads nothing more from us for seconds; and
    // behind the subscriptions to questions, since a program that reads it may ask.
    (port_.answer ? port_.answer : port_.publish)(state("online"));
}

void Registry::disconnected() {
    connected_ = false;
    if (choice_) choice_->disconnected();
    if (!port_.subscribe_values) values_lost();
    catalogue_.suspend();
    feed_.end();
    first_state_.end();
}

void Registry::message(const mqtt::Message& message, Instant now) {
    now_ = now;
    ++statistics_.counts.messages;
    if (message.retain) first_state_.retained_came(now.time);
    if (message.topic == identity_.reply_topic())
        return first_state_.mark(message.payload) ? void() : identity(message);
    if (message.topic == bus::forget_topic(topics_) || message.topic == bus::forget_topic(topics_, id_))
        return endpoint_.forget(message);
    if (choice_ && choice_->dashboard(message, [this] { return board_names(); })) return;
    const auto topic = topics_.parse(message.topic);
    if (!topic) {
        if (message.retain) {
            const std::string_view rest = std::string_view(message.topic).substr(topics_.root().size() + 1);
            tidier_.retained(message.topic, rest.substr(0, rest.find('/')));
        }
        catalogue_.count_refused(Refusal::kBadName);
        return refused(message, {}, Refusal::kBadName);
    }
    switch (topic->kind) {
        case TopicKind::kRegistryQuery:
            if (identity_.is_probe(message)) return;
            [[fallthrough]];
        case TopicKind::kAnyRegistryQuery:
            return endpoint_.request(message, topic->kind == TopicKind::kAnyRegistryQuery, now_.time);
        case TopicKind::kRegistryStats:
            return identity(message);
        case TopicKind::kRegistryState:
            return own_state(message);
        case TopicKind::kProbe:
            return;
        case TopicKind::kStats:
        case TopicKind::kLog:
        case TopicKind::kDemand:
        case TopicKind::kServiceSet:
        case TopicKind::kProperties:
        case TopicKind::kLinks:
        case TopicKind::kLink:
            if (message.retain) tidier_.retained(message.topic, topic->board);
            return;
        case TopicKind::kValues:
            if (message.retain) tidier_.retained(message.topic, topic->board);
            if (choice_) choice_->values(std::string(topic->board), message.payload);
            return;
        case TopicKind::kCommands:
            if (message.retain) return tidier_.retained(message.topic, topic->board);
            if (history_ != nullptr) history_->command(topic->board, message.payload, now_);
            return;
        case TopicKind::kStop:
        case TopicKind::kBoardIn:
        case TopicKind::kServiceIn:
        case TopicKind::kServiceError:
        case TopicKind::kBoardOut:
        case TopicKind::kServiceOut:
            if (message.retain) return tidier_.retained(message.topic, topic->board);
            [[fallthrough]];
        default:
            announcement(message, *topic);
    }
}

void Registry::announcement(const mqtt::Message& message, const bus::TopicRef& topic) {
    const Announcement announcement{topic.kind, topic.board, message.payload, message.retain,
                                    message.expiry_seconds};
    const Applied applied = catalogue_.apply(announcement, now_.time);
    if (choice_) choice_->description(message, now_.time);
    if (applied.refused) refused(message, topic.board, *applied.refused);
    if (!applied.events.empty()) handle(applied.events, false);
}

void Registry::refused(const mqtt::Message& message, std::string_view board, Refusal refusal) {
    const auto line = refusals_.refused(message, board, refusal);
    if (!line) return;
    std::vector<log::Field> fields{{"reason", line->reason}, {"topic", line->topic}};
    if (!line->where.empty()) fields.push_back({"where", line->where});
    fields.push_back({"payload", line->payload});
    log::write(log::Level::kWarning, "refused a message (logged once)", fields);
}

void Registry::identity(const mqtt::Message& message) {
    const auto other = identity_.other(message);
    if (!other) return;
    const bool starting = statistics_.counts.connections == 1 && message.topic == identity_.reply_topic() &&
                          statistics_.age(now_.time) < kStartTime;
    if (starting) {
        id_taken_by_ = *other;
        return;
    }
    // The will or the "offline" of the other one may still replace our state.
    state_due_ = now_.time + kStateRepeat;
    if (identity_logged_ == Time{} || now_.time - identity_logged_ >= kIdentityLogInterval) {
        identity_logged_ = now_.time;
        log::warning("another registry uses this id: watchers see the changes of both; give one another --id",
                     {{"id", id_}, {"its epoch", *other}});
    }
}

// The will of a connection that we left comes late, where the next broker is another one or was given another
// identifier. What is retained was there before we said that we are online.
void Registry::own_state(const mqtt::Message& message) {
    if (!message.retain && message.payload != "online") state_due_ = now_.time + kStateRepeat;
}

bool Registry::may_answer(const std::string& topic) {
    if (!has_user_ || bus::may_answer_on(topic, topics_, "registry")) return true;
    ++statistics_.counts.denied;
    if (!std::exchange(stray_answer_logged_, true))
        log::warning(
            "a query names a topic for its answer on which registries do not answer. Where the broker knows "
            "its users, that is below " +
                topics_.root() + "/reply/USER/registry/",
            {{"topic", topic.substr(0, 200)}});
    return false;
}

void Registry::denied(const std::string& topic, const std::string& reason, Instant now) {
    now_ = now;
    ++statistics_.counts.denied;
    if (!tidier_.denied(topic, now.time)) {
        if (!denied_.contains(topic) && denied_.size() < kMaxDeniedLogged && denied_.insert(topic).second)
            log::warning(mqtt::denied_text(user_, topic.substr(0, 200), reason, "registry"));
        return;
    }
    log::warning(
        "the broker's access rules do not let this registry clear what is left of a board; nothing more is "
        "cleared for an hour. Allow its user to write there, or clear it as a user who may: asipctl forget "
        "--leftovers",
        {{"topic", topic.substr(0, 200)}, {"reason", reason}});
}

void Registry::answer_in_turn(Instant now) {
    now_ = now;
    endpoint_.turn();
}

void Registry::tick(Instant now) {
    now_ = now;
    if (connected_ && state_due_ && now.time >= *state_due_) {
        state_due_.reset();
        port_.publish(state("online"));
    }
    if (connected_) tick_connected();
    if (history_ != nullptr) history_->tick(catalogue_, now);
    if (values_ != nullptr) values_->tick(now);
    last_tick_ = now.time;
}

void Registry::tick_connected() {
    if (now_.time - last_tick_ > kStall) {
        log::warning("was held up; leases get time to be renewed",
                     {{"seconds", std::chrono::duration<double>(now_.time - last_tick_).count()}});
        catalogue_.resume(now_.time);
    }
    handle(catalogue_.expire(now_.time, Catalogue::kJudgedAtOnce), true);
    tidier_.tick(now_.time);
    names_only_.tick(now_.time);
    if (choice_) choice_->tick(now_.time);
    endpoint_.tick(now_.time);
    first_state_.tick(now_.time);
    if (first_state_.active()) return;
    if (auto reset = feed_.reset(now_, port_.queued())) publish(*reset);
    publish_changes();
    catalogue_.settle();
    if (statistics_.due(now_.time)) publish_statistics();
}

}  // namespace asip::registry
