#include "registry/application.hpp"

#include <algorithm>
#include <stdexcept>

#include "asip/bus/change_event.hpp"
#include "asip/model/model_set.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "registry/history.hpp"
#include "registry/stats_text.hpp"

namespace asip::registry {
namespace {

namespace log = program::log;
using bus::TopicKind;

constexpr Duration kTick = std::chrono::milliseconds(100);
// A process that did not run for this long has messages waiting that are older than the leases it would
// judge.
constexpr Duration kStall = std::chrono::seconds(2);
constexpr Duration kSettleLimit = std::chrono::seconds(15);
constexpr std::size_t kMostQueuedEvents = 2000;
constexpr std::size_t kMostComplaints = 1000;

UnitsOf units_of(const std::string& folder) {
    model::ModelSet models = model::ModelSet::standard();
    if (!folder.empty()) {
        if (auto loaded = models.load_directory(folder); !loaded) throw std::runtime_error(loaded.error());
    }
    return [models = std::move(models)](std::string_view reference) {
        std::vector<std::string> units;
        const auto model = models.find_ref(reference);
        if (!model) return units;
        for (const auto& event : model->events) {
            for (const auto& field : event.fields) {
                if (!field.unit.empty()) units.push_back(field.unit);
            }
        }
        return units;
    };
}

// Refusals that a person should look after; the others are the ordinary noise of replays.
bool worth_a_line(Refusal refusal) {
    switch (refusal) {
        case Refusal::kNotForUs:
        case Refusal::kOldSequence:
        case Refusal::kOldSession:
        case Refusal::kUnproven:
        case Refusal::kConflict:
        case Refusal::kOldHint:
            return false;
        default:
            return true;
    }
}

}  // namespace

Application::Application(RegistryOptions options)
    : options_(std::move(options)),
      topics_(options_.topic_root),
      random_(system_random()),
      timer_(io_),
      catalogue_(catalogue_options()),
      run_(random_hex(random_, 8)) {
    if (!options_.history.empty()) {
        history_ = std::make_unique<History>(
            History::Options{options_.history, options_.history_age, options_.history_bytes});
    }
    queries_ = std::make_unique<QueryService>(options_.id, query_dependencies());
    const auto is_alive = [this](const std::string& board) {
        const auto item = catalogue_.board(board, now());
        return item && item->state != "lost" && item->state != "offline";
    };
    tidier_ = std::make_unique<Tidier>(topics_, bus_port(), is_alive);
    listener_ = std::make_unique<TrafficListener>(topics_, bus_port());
    client_ = std::make_unique<mqtt::Client>(io_, mqtt_options(), handlers());
    stop_signal_ = std::make_unique<program::StopSignal>(io_, [this](int) { stop(); });
    catalogue_.suspend();
}

Application::~Application() = default;

Instant Application::now() {
    return {Clock::now(), std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now())};
}

Catalogue::Options Application::catalogue_options() const {
    Catalogue::Options result;
    result.forget_after = options_.forget_after;
    result.max_boards = options_.max_boards;
    result.units_of = units_of(options_.services);
    result.hash_seed = random_();
    return result;
}

QueryService::Dependencies Application::query_dependencies() {
    QueryService::Dependencies result{catalogue_, [] { return now(); }, {}, {}};
    result.forgotten = [this](const std::vector<Event>& events) { handle(events, true); };
    if (history_)
        result.history = [this](const bus::Query& query) -> Expected<bus::Answer> {
            if (!history_) return fail("the history could not be written and was given up; see the log");
            try {
                return history_->find(query);
            } catch (const std::exception& error) {
                return fail(std::string("the history cannot be read: ") + error.what());
            }
        };
    return result;
}

BusPort Application::bus_port() {
    BusPort port;
    port.publish = [this](mqtt::Message message) {
        client_->publish(std::move(message), mqtt::Priority::kAnnouncement);
    };
    port.subscribe = [this](std::string filter, bool with_retained) {
        mqtt::SubscribeOptions subscription;
        subscription.retained = with_retained;
        client_->subscribe(std::move(filter), subscription);
    };
    port.unsubscribe = [this](const std::string& filter) { client_->unsubscribe(filter); };
    return port;
}

mqtt::Options Application::mqtt_options() const {
    mqtt::Options mqtt = options_.mqtt;
    mqtt::Message will;
    will.topic = topics_.registry_state(options_.id);
    will.payload = "lost";
    will.retain = true;
    will.qos = 1;
    mqtt.will = std::move(will);
    mqtt.max_queued_messages = 4 * kMostQueuedEvents;
    mqtt.max_queued_bytes = 32u << 20;
    return mqtt;
}

mqtt::Client::Handlers Application::handlers() {
    mqtt::Client::Handlers result;
    result.on_connected = [this](const mqtt::Connected& connected) { on_connected(connected); };
    result.on_disconnected = [this](const mqtt::ConnectionFailure& failure) { on_disconnected(failure); };
    result.on_connect_failed = [this](const mqtt::ConnectionFailure& failure) { on_connect_failed(failure); };
    result.on_message = [this](const mqtt::Message& message) { on_message(message); };
    result.on_subscribe_refused = [](const std::string& filter, const std::string& reason) {
        log::error("the broker refuses a subscription; check its access rules",
                   {{"filter", filter}, {"reason", reason}});
    };
    return result;
}

int Application::run() {
    started_ = Clock::now();
    log::info("registry starts", {{"id", options_.id}, {"broker", options_.mqtt.brokers.front().describe()}});
    // QoS 0 for announcements: they repeat, and brokers bound what they queue at QoS 1 below what they
    // retain.
    client_->subscribe(topics_.root() + "/servicebus/#");
    mqtt::SubscribeOptions reliable;
    reliable.qos = 1;
    reliable.retained = false;
    client_->subscribe(topics_.any_registry_query(), reliable);
    client_->subscribe(topics_.registry_query(options_.id), reliable);
    client_->start();
    schedule_tick();
    io_.run();
    return status_;
}

void Application::on_connected(const mqtt::Connected& connected) {
    outage_.over();
    log::info("connected", {{"broker", connected.broker.describe()}, {"mqtt", connected.v5 ? "5" : "3.1.1"}});
    const Time present = Clock::now();
    catalogue_.resume(present);
    ++connections_;
    epoch_ = run_ + "-" + std::to_string(connections_);
    queries_->set_epoch(epoch_);
    queries_->set_settling(true);
    queries_->set_max_bytes(connected.max_packet_bytes);
    settling_ = true;
    settle_limit_ = present + kSettleLimit;
    publish_state("online");

    // What the broker retains comes before this, because it was asked for before; then the living answer the
    // probe.
    sync_token_ = random_hex(random_, 16);
    mqtt::Message sync;
    sync.topic = topics_.registry_query(options_.id);
    sync.payload = sync_token_;
    client_->publish(std::move(sync), mqtt::Priority::kAnnouncement);
    mqtt::Message probe;
    probe.topic = topics_.probe();
    client_->publish(std::move(probe), mqtt::Priority::kAnnouncement);
}

void Application::on_disconnected(const mqtt::ConnectionFailure& failure) {
    catalogue_.suspend();
    log::warning("connection lost; the catalogue is kept and checked when the broker is back",
                 {{"why", failure.text}, {"boards", catalogue_.size()}});
}

void Application::on_connect_failed(const mqtt::ConnectionFailure& failure) {
    if (failure.hopeless) {
        log::error("no broker accepts the connection",
                   {{"broker", failure.broker.describe()}, {"why", failure.text}});
        status_ = program::kExitBroker;
        stop();
        return;
    }
    const auto level = outage_.is_news(failure) ? log::Level::kWarning : log::Level::kDebug;
    log::write(level, "no connection; trying again",
               {{"broker", failure.broker.describe()}, {"why", failure.text}});
}

void Application::on_message(const mqtt::Message& message) {
    ++messages_;
    const auto topic = topics_.parse(message.topic);
    if (!topic) {
        if (message.retain) {
            const std::string_view rest = std::string_view(message.topic).substr(topics_.root().size() + 1);
            tidier_->retained(message.topic, rest.substr(0, rest.find('/')));
        }
        note_refusal(message, {TopicKind::kProbe, {}, {}}, Refusal::kBadName);
        return;
    }
    switch (topic->kind) {
        case TopicKind::kRegistryQuery:
            if (message.payload == sync_token_) return settled();
            [[fallthrough]];
        case TopicKind::kAnyRegistryQuery:
            if (auto answer = queries_->answer(message)) {
                ++queries_answered_;
                client_->publish(std::move(*answer), mqtt::Priority::kReply);
            }
            return;
        case TopicKind::kProbe:
            return;
        case TopicKind::kBoardIn:
        case TopicKind::kServiceIn:
        case TopicKind::kServiceError:
        case TopicKind::kBoardOut:
        case TopicKind::kServiceOut:
            if (message.retain) return tidier_->retained(message.topic, topic->board);
            [[fallthrough]];
        default:
            on_announcement(message, *topic);
    }
}

void Application::on_announcement(const mqtt::Message& message, const bus::TopicRef& topic) {
    const Announcement announcement{topic.kind, topic.board, message.payload, message.retain,
                                    message.expiry_seconds};
    const Applied applied = catalogue_.apply(announcement, Clock::now());
    if (applied.refused && worth_a_line(*applied.refused)) note_refusal(message, topic, *applied.refused);
    if (!applied.events.empty()) handle(applied.events, false);
}

void Application::note_refusal(const mqtt::Message& message, const bus::TopicRef& topic, Refusal refusal) {
    if (complained_.size() >= kMostComplaints) return;
    const std::string source(topic.board.empty() ? std::string_view(message.topic) : topic.board);
    if (!complained_.insert(std::string(to_text(refusal)) + " " + source.substr(0, 100)).second) return;
    log::warning("refused a message (told once)", {{"reason", to_text(refusal)},
                                                   {"topic", message.topic.substr(0, 200)},
                                                   {"payload", message.payload.substr(0, 80)}});
}

void Application::settled() {
    if (!settling_) return;
    settling_ = false;
    sync_token_.clear();
    queries_->set_settling(false);
    log::info("catalogue is complete", {{"boards", catalogue_.size()}});
    tell_reset();
    publish_stats();
}

void Application::handle(const std::vector<Event>& events, bool decided_here) {
    for (const Event& event : events) {
        switch (event.kind) {
            case Event::Kind::kGhost:
                tidier_->ghost(event.board, Clock::now());
                break;
            case Event::Kind::kListen:
                listener_->listen(event.board, Clock::now());
                break;
            case Event::Kind::kUnlisten:
                listener_->unlisten(event.board);
                break;
            default:
                keep(event);
                if (event.kind == Event::Kind::kForgotten && decided_here) tidier_->forgotten(event.board);
                if (event.kind == Event::Kind::kConflict) {
                    log::warning("two agents claim one board; stop one or give it another --name",
                                 {{"board", event.board}});
                }
                tell(event);
        }
    }
}

void Application::keep(const Event& event) {
    try {
        if (history_) history_->add(event, now().wall);
    } catch (const std::exception& error) {
        give_up_history(error.what());
    }
}

// A full disk must not take the catalogue with it.
void Application::give_up_history(const std::string& why) {
    log::error("history cannot be written; going on without", {{"file", options_.history}, {"why", why}});
    history_.reset();
}

void Application::tell(const Event& event) {
    if (settling_ || reset_due_ || !client_->connected()) {
        reset_due_ = true;
        return;
    }
    if (client_->counters().queued > kMostQueuedEvents) {
        log::warning("changes come faster than the broker takes them; watchers will be told to start over");
        reset_due_ = true;
        return;
    }
    const Instant present = now();
    bus::ChangeEvent change;
    change.kind = static_cast<bus::ChangeEvent::Kind>(event.kind);
    change.registry = options_.id;
    change.epoch = epoch_;
    change.seq = event.seq;
    change.at = present.wall;
    change.reason = to_text(event.reason);
    if (event.kind == Event::Kind::kState) change.was = model::to_text(event.was);
    auto item = catalogue_.board(event.board, present);
    if (item) change.board = std::move(*item);
    change.board.board = event.board;
    // The item is as it is now; with several changes at once each event shows its own state.
    change.board.state = model::to_text(event.state);
    for (auto& service : change.board.services)
        service.state = change.board.state;
    mqtt::Message message;
    message.topic = topics_.registry_events(options_.id);
    message.payload = bus::encode(change);
    client_->publish(std::move(message), mqtt::Priority::kAnnouncement);
    ++events_told_;
}

void Application::tell_reset() {
    reset_due_ = false;
    bus::ChangeEvent change;
    change.kind = bus::ChangeEvent::Kind::kReset;
    change.registry = options_.id;
    change.epoch = epoch_;
    change.seq = catalogue_.seq();
    change.at = now().wall;
    mqtt::Message message;
    message.topic = topics_.registry_events(options_.id);
    message.payload = bus::encode(change);
    client_->publish(std::move(message), mqtt::Priority::kAnnouncement);
}

void Application::publish_state(std::string_view word) {
    mqtt::Message message;
    message.topic = topics_.registry_state(options_.id);
    message.payload = word;
    message.retain = true;
    message.qos = 1;
    client_->publish(std::move(message), mqtt::Priority::kAnnouncement);
}

void Application::publish_stats() {
    const Time present = Clock::now();
    const double seconds = std::max(
        0.001, std::chrono::duration<double>(present - next_stats_ + options_.stats_interval).count());
    StatsInput input;
    input.version = ASIP_VERSION;
    input.epoch = epoch_;
    input.seq = catalogue_.seq();
    input.at = now().wall;
    input.uptime_seconds = std::chrono::duration<double>(present - started_).count();
    input.connections = connections_;
    input.messages = messages_;
    input.messages_per_second = static_cast<double>(messages_ - messages_before_) / seconds;
    input.queries = queries_answered_;
    input.events = events_told_;
    mqtt::Message message;
    message.topic = topics_.registry_stats(options_.id);
    message.payload = stats_text(catalogue_.stats(), catalogue_.services_by_kind(), input);
    message.retain = true;
    client_->publish(std::move(message), mqtt::Priority::kAnnouncement);
    messages_before_ = messages_;
    next_stats_ = present + options_.stats_interval;
}

void Application::schedule_tick() {
    timer_.expires_after(kTick);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (!error) tick();
    });
}

void Application::tick() {
    const Time present = Clock::now();
    if (client_->connected()) {
        if (last_tick_ != Time{} && present - last_tick_ > kStall) {
            log::warning("was held up; leases get time to be renewed",
                         {{"seconds", std::chrono::duration<double>(present - last_tick_).count()}});
            catalogue_.resume(present);
        }
        handle(catalogue_.expire(present), true);
        tidier_->tick(present);
        listener_->tick(present);
        if (settling_ && present >= settle_limit_) settled();
        if (!settling_ && reset_due_ && client_->counters().queued < kMostQueuedEvents / 10) tell_reset();
        if (!settling_) catalogue_.settle();
        if (!settling_ && present >= next_stats_) publish_stats();
    }
    try {
        if (history_) history_->tick(present);
    } catch (const std::exception& error) {
        give_up_history(error.what());
    }
    last_tick_ = present;
    schedule_tick();
}

void Application::stop() {
    publish_state("offline");
    client_->stop(std::chrono::seconds(2), [this] {
        timer_.cancel();
        stop_signal_->cancel();
        io_.stop();
    });
}

}  // namespace asip::registry
