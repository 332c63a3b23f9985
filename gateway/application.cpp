// SPDX-License-Identifier: Apache-2.0
#include "gateway/application.hpp"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <utility>

#include "asip/caller/caller.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/log.hpp"
#include "asip/program/open_files.hpp"
#include "asip/program/path.hpp"
#include "asip/random.hpp"
#include "asip/text/wall_time.hpp"
#include "gateway/cable/agent_way.hpp"

namespace asip::gateway {
namespace {

namespace log = program::log;

constexpr std::size_t kSocketBytes = 32 * 1024;  // of a WebSocket, beside the message that it reads
constexpr std::uint32_t kMaxStopAnswer = 16 * 1024;
constexpr Duration kSoon = std::chrono::milliseconds(1);
constexpr Duration kLastWords = std::chrono::milliseconds(10);  // of WebSockets
constexpr const char* kHomeAssistant = "homeassistant/status";
constexpr Duration kTick = std::chrono::milliseconds(100);
constexpr Duration kTokensCheck = std::chrono::milliseconds(250);

Instant present() {
    return {Clock::now(), text::wall_now()};
}

/// Whether a program stands in PATH, or beside this one.
bool has_program(const std::string& name) {
    std::error_code error;
    const auto own = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    return program::is_in_path(name) || program::is_program(own / name);
}

}  // namespace

Application::Application(ProgramOptions options)
    : options_(std::move(options)),
      timer_(io_),
      soon_(io_),
      shares_(bus::Shares::processor_time,
              [this] {
                  if (handles_)
                      waits_ = true;
                  else
                      turn();
              }),
      boards_(
          shares_, [this](const mqtt::Message& received) { handle(received); },
          [this](const std::string& topic) {
              if (gateway_->mirror().topics().parse(topic).value().kind == bus::TopicKind::kServiceOut)
                  gateway_->mirror().values().count_left_out(1);
          }) {
    program::allow_many_open_files();  // each connection needs one
    auto models = model::ModelSet::standard_and(options_.services);
    if (!models) throw std::runtime_error(models.error());
    auto units_of = [models = *models](std::string_view model) { return model::units_of(models, model); };
    auto mqtt = options_.mqtt;
    mqtt.max_queued_messages = 20'000;
    mqtt.max_queued_bytes = 32u << 20;
    mqtt::Client::Handlers calls;
    calls.on_subscribed = [this] { gateway_->can_call(); };
    calls.on_disconnected = [this](const mqtt::ConnectionFailure& why) { gateway_->cannot_call(why); };
    asker_ = connection_for_answers(mqtt, "-commands", std::move(calls));
    auto short_answers = mqtt;
    short_answers.max_packet_bytes = kMaxStopAnswer;
    stopper_ = connection_for_answers(short_answers, "-stop", {});
    client_ = std::make_unique<mqtt::Client>(io_, std::move(mqtt), handlers());
    options_.gateway.simulator = has_program("asip-sim");
    options_.gateway.socket_bytes = options_.limits.message_bytes + kSocketBytes;
    gateway_ = std::make_unique<Gateway>(options_.gateway, std::move(*models), std::move(units_of),
                                         system_random(), random_secret, port());
    for (const auto& each : options_.exports)
        exports_.push_back(std::make_unique<Exports>(io_, each, options_.mqtt, *gateway_));
    read_tokens(true);
    http::Server::Options server;
    server.addresses = options_.addresses;
    server.limits = options_.limits;
    if (!options_.http_cert.empty())
        server.tls =
            std::make_unique<http::Server::Tls>(http::Server::Tls{options_.http_cert, options_.http_key});
    server_ = std::make_unique<http::Server>(
        io_, std::move(server), shares_,
        [this](const http::Request& request) { return gateway_->asker_of(request); },
        [this](const http::Request& request, const http::Reply& reply) {
            gateway_->request(request, reply);
        });
    stop_signal_ = std::make_unique<program::StopSignal>(io_, [this](int) { stop(); });
}

Application::~Application() = default;

// Sockets are looked at between two turns.
void Application::turn() {
    boost::asio::post(io_, [this] {
        if (shares_.run()) turn();
    });
}

// What a message brings to a browser leaves before the next message is read.
template <class Handle>
void Application::then_run(Handle handle) {
    handles_ = true;
    handle();
    handles_ = false;
    if (std::exchange(waits_, false) && shares_.run()) turn();
}

Gateway::Port Application::port() {
    Gateway::Port port;
    port.calls = caller::port_of(*asker_);
    port.calls.unacknowledged = nullptr;  // what others have published is under way at any time
    port.publish = [this](mqtt::Message message) {
        return client_->publish(std::move(message), mqtt::Priority::kReply) != mqtt::PublishResult::kRefused;
    };
    port.urgent_ready = [this] { return stopper_->subscribed(); };
    port.calls.publish_first = [this](mqtt::Message message) {
        auto& client = stopper_->subscribed() ? stopper_ : asker_;
        return client->publish(std::move(message), mqtt::Priority::kUrgent) != mqtt::PublishResult::kRefused;
    };
    port.subscribe = [this](const std::string& filter, bool retained) {
        client_->subscribe(filter, {.retained = retained});
    };
    port.unsubscribe = [this](const std::string& filter) { client_->unsubscribe(filter); };
    port.now = present;
    port.server = [this] { return server_->counters(); };
    port.exports = [this] { return exports_stand(); };
    if (!options_.cables.empty())
        port.cable = [this](CableWay::Handlers handlers) {
            return agent_way(io_, options_.cables, std::move(handlers));
        };
    port.soon = [this](std::function<void()> then) {
        soon_.expires_after(kSoon);
        soon_.async_wait([then = std::move(then)](const boost::system::error_code& error) {
            if (!error) then();
        });
    };
    return port;
}

mqtt::Client::Handlers Application::handlers() {
    mqtt::Client::Handlers result;
    result.on_connected = [this](const mqtt::Connected& connected) { broker_log_.connected(connected); };
    result.on_subscribed = [this] {
        gateway_->subscribed();
        for (const auto& each : exports_)
            each->subscribed();
    };
    result.on_disconnected = [this](const mqtt::ConnectionFailure& failure) {
        boards_.disconnected();
        gateway_->disconnected();
        for (const auto& each : exports_)
            each->disconnected();
        log::warning("connection lost; what is known is still shown", {{"why", failure.text}});
    };
    result.on_connect_failed = [this](const mqtt::ConnectionFailure& failure) { connect_failed(failure); };
    result.on_message = [this](const mqtt::Message& received) { then_run([&] { message(received); }); };
    add_refusals(result);
    return result;
}

void Application::add_refusals(mqtt::Client::Handlers& to) const {
    to.on_publish_denied = [this](const std::string& topic, const std::string& reason) {
        log::warning(mqtt::denied_text(options_.mqtt.user, topic, reason, "gateway"));
        gateway_->denied(topic, reason);
    };
    to.on_subscribe_refused = program::BrokerLog::subscribe_refused;
}

std::unique_ptr<mqtt::Client> Application::connection_for_answers(const mqtt::Options& like, const char* name,
                                                                  mqtt::Client::Handlers handlers) {
    auto options = like;
    options.client_id += name;
    handlers.on_message = [this](const mqtt::Message& received) {
        then_run([&] { gateway_->answer(received); });
    };
    add_refusals(handlers);
    return std::make_unique<mqtt::Client>(io_, std::move(options), std::move(handlers));
}

// While the mirror reads what is retained, no message waits: its mark says that all of them were handled.
void Application::message(const mqtt::Message& received) {
    const auto topic = gateway_->mirror().topics().parse(received.topic);
    if (!topic || !bus::BoardShares::counts(*topic) || gateway_->mirror().reading()) return handle(received);
    boards_.message(topic->board, received, Clock::now());
}

void Application::handle(const mqtt::Message& received) {
    const auto topic = gateway_->mirror().topics().parse(received.topic);
    // A value that is exported goes through a broker once more: ahead of what is kept of it here.
    if (topic)
        for (const auto& each : exports_)
            each->message_of_service(*topic, received);
    gateway_->message(received);
    for (const auto& each : exports_) {
        each->changes();
        if (!topic) each->message(received);
    }
    if (received.topic != kHomeAssistant) return;
    if (!home_assistant_there_ && !options_.exports_on.contains("home-assistant"))
        log::info(
            "Home Assistant is on this broker; with --home-assistant this gateway shows it every board");
    home_assistant_there_ = received.payload == "online";
}

std::vector<ExportStanding> Application::exports_stand() const {
    std::vector<ExportStanding> result;
    for (const auto& each : exports_) {
        const auto& one = each->of();
        auto& standing = result.emplace_back();
        standing.system = one.by();
        standing.title = one.title();
        standing.on = options_.exports_on.contains(standing.system);
        standing.shows = standing.on && one.active();
        if (!one.turn().active() && one.turn().held(present().time))
            standing.other = one.turn().holder()->host;
        if (standing.system == "home-assistant") standing.found = home_assistant_there_;
    }
    return result;
}

void Application::connect_failed(const mqtt::ConnectionFailure& failure) {
    if (!broker_log_.connect_failed(failure, [this](Duration wait) { client_->retry_in(wait); })) return;
    status_ = program::kExitBroker;
    stop();
}

// A file that is being written, or has become wrong, leaves the tokens as they are.
void Application::read_tokens(bool first) {
    if (options_.tokens.empty()) return;
    std::error_code error;
    const auto written = std::filesystem::last_write_time(options_.tokens, error);
    if (!first && !error) {
        if (tokens_read_ == written) return;
        if (std::exchange(tokens_seen_, written) != written) return;  // its writer may not be done
    }
    auto tokens = Tokens::read(options_.tokens);
    if (!tokens) {
        if (first) throw std::runtime_error(tokens.error());
        if (tokens_read_) log::error("the tokens stay as they were", {{"why", tokens.error()}});
        tokens_read_.reset();
        return;
    }
    if (!error) tokens_read_ = written;
    log::info("tokens read", {{"file", options_.tokens}, {"tokens", tokens->all().size()}});
    gateway_->gate().set_tokens(std::move(*tokens));
}

void Application::log_access() const {
    const auto& gate = options_.gateway.gate;
    for (const auto& address : server_->addresses()) {
        const bool tls = !options_.http_cert.empty();
        log::info(
            "listening",
            {{"address", address.starts_with("unix:") ? address : (tls ? "https://" : "http://") + address},
             {"without a token, from this machine", to_string(gate.loopback.role)},
             {"without a token, from elsewhere", to_string(gate.anonymous.role)}});
    }
}

int Application::run() {
    log::info("gateway starts", {{"broker", options_.gateway.broker}});
    for (auto& [filter, retained] : gateway_->subscriptions())
        client_->subscribe(std::move(filter), {.retained = retained});
    for (const auto& each : exports_)
        for (auto& filter : each->subscriptions())
            client_->subscribe(std::move(filter));
    client_->subscribe(kHomeAssistant);
    mqtt::SubscribeOptions replies;
    replies.qos = 1;
    const auto answers = options_.gateway.replies();
    asker_->subscribe(answers.below("+").filter(), replies);
    // Boards know where that is, and can flood it. An acknowledgement of each message would delay an answer.
    stopper_->subscribe(answers.urgent().below("+").filter(), {});
    for (const auto& client : {client_.get(), asker_.get(), stopper_.get()})
        client->start();
    server_->start();
    log_access();
    schedule_tick();
    io_.run();
    return status_;
}

void Application::schedule_tick() {
    timer_.expires_after(kTick);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error) return;
        if (const auto now = Clock::now(); now - tokens_checked_ >= kTokensCheck) {
            tokens_checked_ = now;
            read_tokens(false);
        }
        gateway_->tick();
        boards_.tick(Clock::now());
        for (const auto& each : exports_)
            each->tick();
        schedule_tick();
    });
}

void Application::stop() {
    gateway_->leave();
    server_->stop();
    for (const auto& client : {asker_.get(), stopper_.get()})
        client->stop(std::chrono::seconds(1), [] {});
    auto last = std::make_shared<int>(static_cast<int>(exports_.size()));
    for (const auto& each : exports_)
        each->stop(std::chrono::seconds(2), [this, last] {
            if (--*last == 0) client_->stop(std::chrono::seconds(2), [this] { end(); });
        });
}

void Application::end() {
    timer_.cancel();
    stop_signal_->cancel();
    soon_.expires_after(kLastWords);
    soon_.async_wait([this](const boost::system::error_code&) { io_.stop(); });
}

}  // namespace asip::gateway
