// SPDX-License-Identifier: Apache-2.0
#include "registry/application.hpp"

#include <boost/asio/post.hpp>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "asip/random.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::registry {
namespace {

namespace log = program::log;

constexpr Duration kTick = std::chrono::milliseconds(100);
constexpr int kReadingShare = 4;
constexpr Duration kGather = std::chrono::milliseconds(50);  // values; they are written each 10 s
constexpr std::size_t kMaxUnsent = 64;             // messages; beyond, questions wait here and not answers
constexpr std::uint32_t kMaxQuestion = 64u << 10;  // a packet; bus::kMaxRequestBytes and more than enough

Instant now() {
    return {Clock::now(), text::wall_now()};
}

/// Beside the history: history.values.db
std::string values_file(const std::string& history) {
    std::filesystem::path path(history);
    const auto extension = path.extension();
    return path.replace_extension().string() + ".values" + extension.string();
}

}  // namespace

Application::Application(RegistryOptions options)
    : options_(std::move(options)),
      timer_(io_),
      topics_(options_.topic_root),
      shares_(bus::Shares::processor_time, [this] { share_turn(); }),
      boards_(shares_, [this](const mqtt::Message& received) { take(received); }, [](const std::string&) {}) {
    if (!options_.history.empty()) {
        history_ = std::make_unique<HistoryKeeper>(
            io_, History::Options{options_.history, options_.history_age, options_.history_bytes},
            history_handlers(), boot_id(), now());
        ValueFile::Options file;
        file.path = values_file(options_.history);
        file.max_bytes = options_.values_bytes;
        for (std::size_t level = 0; level < kLevels; ++level)
            file.max_age[level] =
                std::chrono::duration_cast<std::chrono::milliseconds>(options_.values_age[level]).count();
        if (options_.keeps_values)
            values_ = std::make_unique<ValueKeeper>(io_, std::move(file), value_handlers(), now());
    }
    auto models = model::ModelSet::standard_and(options_.services);
    if (!models) throw std::runtime_error(models.error());
    registry_ = std::make_unique<Registry>(options_, std::move(*models), system_random(), port(),
                                           history_.get(), now(), values_.get());
    client_ = std::make_unique<mqtt::Client>(io_, mqtt_options(), handlers());
    answerer_ = connection_for_questions();
    if (values_) valuer_ = connection_for_values();
    if (!options_.notify.empty()) {
        auto webhook = Webhook::create(io_, options_.notify);
        if (!webhook) throw std::runtime_error("--notify: " + webhook.error());
        webhook_ = std::move(*webhook);
    }
    stop_signal_ = std::make_unique<program::StopSignal>(io_, [this](int) { stop(); });
}

Application::~Application() = default;

// A full disk must not end the catalogue, too.
HistoryKeeper::Handlers Application::history_handlers() {
    HistoryKeeper::Handlers result;
    result.failed = [this](const std::string& reason) {
        log::error("history cannot be kept; it is tried again, and changes wait",
                   {{"file", options_.history}, {"why", reason}});
    };
    result.works_again = [this](std::size_t lost) {
        log::warning("history is kept again", {{"file", options_.history}, {"changes lost", lost}});
    };
    result.begun_anew = [this](const std::string& aside, const std::string& damage) {
        log::error("history file is damaged; it was put aside and a new one begun",
                   {{"file", options_.history}, {"put aside as", aside}, {"why", damage}});
    };
    return result;
}

ValueKeeper::Handlers Application::value_handlers() {
    const auto file = values_file(options_.history);
    ValueKeeper::Handlers result;
    result.failed = [file](const std::string& reason) {
        log::error("values cannot be kept; it is tried again, and changes wait",
                   {{"file", file}, {"why", reason}});
    };
    result.works_again = [file](std::size_t lost) {
        log::warning("values are kept again", {{"file", file}, {"changes lost", lost}});
    };
    result.begun_anew = [file](const std::string& aside, const std::string& damage) {
        log::error("file of values is damaged; it was put aside and a new one begun",
                   {{"file", file}, {"put aside as", aside}, {"why", damage}});
    };
    return result;
}

Port Application::port() {
    Port port;
    port.publish = [this](mqtt::Message message) {
        client_->publish(std::move(message), mqtt::Priority::kAnnouncement);
    };
    port.answer = [this](mqtt::Message message) {
        answerer_->publish(std::move(message), mqtt::Priority::kReply);
    };
    port.takes_answers = [this] { return answerer_->counters().queued < kMaxUnsent; };
    port.subscribe = [this](std::string filter, bool retained) {
        mqtt::SubscribeOptions subscription;
        subscription.retained = retained;
        client_->subscribe(std::move(filter), subscription);
    };
    port.unsubscribe = [this](const std::string& filter) { client_->unsubscribe(filter); };
    port.queued = [this] { return client_->counters().queued; };
    if (!values_) return port;
    port.subscribe_values = [this](std::string filter, bool retained) {
        valuer_->subscribe(std::move(filter), {.retained = retained});
    };
    port.unsubscribe_values = [this](const std::string& filter) { valuer_->unsubscribe(filter); };
    return port;
}

mqtt::Options Application::mqtt_options() const {
    mqtt::Options mqtt = options_.mqtt;
    mqtt.will = registry_->will();
    mqtt.max_queued_messages = 4 * ChangeFeed::kMaxQueued;
    mqtt.max_queued_bytes = 32u << 20;
    return mqtt;
}

mqtt::Client::Handlers Application::handlers() {
    mqtt::Client::Handlers result;
    result.on_connected = [this](const mqtt::Connected& connected) {
        broker_log_.connected(connected);
        registry_->connected(connected.max_packet_bytes, now());
    };
    result.on_disconnected = [this](const mqtt::ConnectionFailure& failure) {
        boards_.disconnected();
        registry_->disconnected();
        log::warning("connection lost; the catalogue is kept and checked when the broker is back",
                     {{"why", failure.text}, {"boards", registry_->boards()}});
    };
    result.on_connect_failed = [this](const mqtt::ConnectionFailure& failure) { connect_failed(failure); };
    result.on_message = [this](const mqtt::Message& received) { message(received); };
    result.on_published = [this](const std::string& topic) {
        registry_->published(topic);
        schedule_turn();
    };
    result.on_publish_denied = [this](const std::string& topic, const std::string& reason) {
        registry_->denied(topic, reason, now());
    };
    result.on_subscribe_refused = program::BrokerLog::subscribe_refused;
    return result;
}

/// And for their answers. The broker drops what is too long for a question. With QoS 1 a flood of questions
/// would wait for an acknowledgement of each, and the broker reads one of these in each of its turns.
std::unique_ptr<mqtt::Client> Application::connection_for_questions() {
    auto options = options_.mqtt;
    options.client_id += options.client_id.empty() ? "" : "-answers";
    options.max_queued_bytes = 32u << 20;
    options.max_packet_bytes = kMaxQuestion;
    mqtt::Client::Handlers result;
    result.on_message = [this](const mqtt::Message& received) { take(received); };
    result.on_subscribe_refused = program::BrokerLog::subscribe_refused;
    result.on_published = [this](const std::string&) { schedule_turn(); };
    result.on_publish_denied = [this](const std::string& topic, const std::string& reason) {
        registry_->denied(topic, reason, now());
    };
    auto client = std::make_unique<mqtt::Client>(io_, std::move(options), std::move(result));
    for (auto& filter : registry_->questions())
        client->subscribe(std::move(filter), {.qos = 0, .retained = false});
    return client;
}

std::unique_ptr<mqtt::Client> Application::connection_for_values() {
    auto options = options_.mqtt;
    options.client_id += options.client_id.empty() ? "" : "-values";
    options.gather = kGather;
    mqtt::Client::Handlers result;
    result.on_disconnected = [this](const mqtt::ConnectionFailure&) { registry_->values_lost(); };
    result.on_message = [this](const mqtt::Message& received) { message(received); };
    result.on_subscribe_refused = program::BrokerLog::subscribe_refused;
    return std::make_unique<mqtt::Client>(io_, std::move(options), std::move(result));
}

int Application::run() {
    log::info("registry starts", {{"id", options_.id}, {"broker", options_.mqtt.brokers.front().describe()}});
    for (auto& [filter, qos, retained] : registry_->subscriptions()) {
        mqtt::SubscribeOptions subscription;
        subscription.qos = qos;
        subscription.retained = retained;
        client_->subscribe(std::move(filter), subscription);
    }
    answerer_->start();
    client_->start();
    if (valuer_) valuer_->start();
    schedule_tick();
    io_.run();
    return status_;
}

void Application::connect_failed(const mqtt::ConnectionFailure& failure) {
    if (!broker_log_.connect_failed(failure, [this](Duration wait) { client_->retry_in(wait); })) return;
    status_ = program::kExitBroker;
    stop();
}

void Application::message(const mqtt::Message& received) {
    const auto topic = topics_.parse(received.topic);
    if (!topic || !bus::BoardShares::counts(*topic) || registry_->reading()) return take(received);
    arrived_ = true;
    schedule_turn();
    boards_.message(topic->board, received, Clock::now());
}

// What else there is to do is done between two turns.
void Application::share_turn() {
    boost::asio::post(io_, [this] {
        if (shares_.run()) share_turn();
    });
}

void Application::take(const mqtt::Message& received) {
    registry_->message(received, now());
    arrived_ = true;
    schedule_turn();
    if (!registry_->id_taken_by() || status_ != 0) return;
    log::error("another registry uses this id; give this one another with --id",
               {{"id", options_.id}, {"its epoch", *registry_->id_taken_by()}});
    status_ = program::kExitNameConflict;
    stopping_ = true;
    client_->stop(std::chrono::seconds(1), [this] { end(); });
}

void Application::schedule_tick() {
    timer_.expires_after(kTick);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error || stopping_) return;
        registry_->tick(now());
        boards_.tick(Clock::now());
        schedule_turn();
        notify();
        schedule_tick();
    });
}

/// Behind what the connection has to read. While more comes, reading gets kReadingShare times what the last
/// answer took, so that a flood of costly questions does not pile up in front of others.
void Application::schedule_turn() {
    if (!registry_->questions_wait()) return;
    if (std::exchange(turn_scheduled_, true)) return;
    boost::asio::post(io_, [this] {
        turn_scheduled_ = false;
        if (stopping_) return;
        const auto begin = Clock::now();
        if (std::exchange(arrived_, false) && begin < reads_until_) return schedule_turn();
        registry_->answer_in_turn(now());
        const auto end = Clock::now();
        reads_until_ = end + kReadingShare * (end - begin);
        schedule_turn();
    });
}

void Application::notify() {
    auto* notices = webhook_ ? registry_->notices() : nullptr;
    auto message = notices != nullptr ? notices->next(now()) : std::nullopt;
    if (!message) return;
    webhook_->post(
        std::move(*message), [this, notices](Webhook::Result result, const std::string& why, Duration wait) {
            if (result == Webhook::Result::kFailed) {
                notices->failed(Clock::now(), wait);
                if (!std::exchange(notify_fault_logged_, true))
                    log::warning(
                        "no notice of lost boards can be delivered now; it is tried again, with what happens "
                        "meanwhile",
                        {{"address", webhook_->shown()}, {"why", why}});
                return;
            }
            result == Webhook::Result::kRefused ? notices->refused(Clock::now())
                                                : notices->delivered(Clock::now());
            if (result == Webhook::Result::kRefused)
                log::error("the address of --notify takes no messages; this one is dropped",
                           {{"address", webhook_->shown()}, {"why", why}});
            else if (std::exchange(notify_fault_logged_, false))
                log::info("messages of lost boards are delivered again", {{"address", webhook_->shown()}});
        });
}

void Application::stop() {
    stopping_ = true;  // nothing is said behind the goodbye
    answerer_->stop(std::chrono::seconds(1), [] {});
    if (valuer_) valuer_->stop(std::chrono::seconds(1), [] {});
    client_->publish(registry_->goodbye(), mqtt::Priority::kAnnouncement);
    client_->stop(std::chrono::seconds(2), [this] { end(); });
}

void Application::end() {
    timer_.cancel();
    stop_signal_->cancel();
    io_.stop();
}

}  // namespace asip::registry
