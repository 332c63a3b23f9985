#include "asip/mqtt/client.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>

#include "asip/mqtt/backoff.hpp"
#include "asip/mqtt/connection.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/mqtt/outbox.hpp"

namespace asip::mqtt {
namespace {

namespace asio = boost::asio;
using Kind = ConnectionFailure::Kind;

/// Unacknowledged QoS 1 messages: what libmosquitto and Mosquitto both allow unless told otherwise.
constexpr std::size_t kMaxUnacknowledged = 20;
constexpr std::size_t kMaxPropertyBytes = 65535;
/// "Closed before answering" can be a broker that is just going down; only the second time in a row it is
/// taken as "does not know MQTT 5".
constexpr int kSuspicionsUntilFallback = 2;
constexpr int kUnansweredUntilTls = 3;
constexpr int kFirstErrorCode = 128;
constexpr auto kHeldLongEnough = std::chrono::seconds(5);

bool can_be_published(const Message& message) {
    return !message.topic.empty() && message.qos >= 0 && message.qos <= 1 &&
           mosquitto_pub_topic_check(message.topic.c_str()) == 0 &&
           message.topic.find('\0') == std::string::npos && message.topic.size() <= kMaxPropertyBytes &&
           mosquitto_validate_utf8(message.topic.data(), static_cast<int>(message.topic.size())) == 0 &&
           message.payload.size() <= MQTT_MAX_PAYLOAD && message.correlation.size() <= kMaxPropertyBytes &&
           message.response_topic.size() <= kMaxPropertyBytes;
}

/// Errors that say that the connection is gone, and nothing about the message.
bool is_connection_error(int error) {
    return error == MOSQ_ERR_NO_CONN || error == MOSQ_ERR_CONN_LOST || error == MOSQ_ERR_ERRNO ||
           error == MOSQ_ERR_TLS || error == MOSQ_ERR_NOMEM;
}

}  // namespace

class Client::Impl final : public ConnectionEvents, public std::enable_shared_from_this<Impl> {
  public:
    Impl(asio::io_context& io, Options options, Handlers handlers);

    void start() { attempt(); }
    void stop(Duration limit, std::function<void()> done);
    void close();

    void set_will(Message will) { options_.will = std::move(will); }
    void subscribe(std::string filter, SubscribeOptions options);
    void unsubscribe(const std::string& filter);
    PublishResult publish(Message message, Priority priority);
    void discard_queued(Priority priority) { outbox_.discard(priority); }

    bool connected() const { return connection_ && connection_->up(); }
    bool subscribed() const { return connected() && subscriptions_.all_granted(); }
    bool v5() const { return connected() && connection_->v5(); }
    const std::string& client_id() const { return options_.client_id; }
    Counters counters() const;

  private:
    struct Broker {
        BrokerAddress address;
        bool speaks_v5 = true;
        int suspicions = 0;           ///< attempts with MQTT 5 in a row that were closed without an answer
        int unanswered = 0;           ///< attempts in a row, with any version, that had no answer
        bool failed_fatally = false;  ///< the last time
    };
    struct Unacknowledged {
        Outbox::Entry entry;
        Time sent;
    };

    void connection_up(const Connected& connected) override;
    void connection_down(const End& end) override;
    void message_received(Message message) override;
    void publish_answered(int id, int reason_code) override;
    void subscribe_answered(int id, const std::vector<int>& granted) override;
    void may_write() override { flush(); }
    void tick(Time now) override;
    void debug_line(const std::string& line) override;

    Broker& broker() { return brokers_[broker_]; }
    void attempt();
    void resolve();
    void connect_next_address();
    void learn(const End& end);
    void retry(bool same_broker_at_once);
    void look_up_took_too_long();
    void send_subscriptions();
    void fail_if_stalled(Time now);
    bool hopeless() const;
    bool window_open(const Message& message) const {
        return message.qos == 0 || unacknowledged_.size() < kMaxUnacknowledged;
    }
    /// Handlers are kept, and no longer called: one of them may be what called stop().
    bool silent() const { return closed_ || stopped_; }
    int send(Outbox::Entry entry);
    void flush();
    void requeue_unacknowledged();
    void leave_when_sent();
    void finish();

    asio::io_context& io_;
    Options options_;
    Handlers handlers_;
    std::vector<Broker> brokers_;
    std::size_t broker_ = 0;
    std::size_t failures_this_round_ = 0;
    Backoff backoff_;
    asio::steady_timer retry_timer_;
    asio::ip::tcp::resolver resolver_;
    std::vector<std::string> addresses_;  ///< of this attempt, those not yet tried; the next one last
    std::shared_ptr<Connection> connection_;
    asio::steady_timer lookup_timer_;
    unsigned lookups_ = 0;
    bool was_up_ = false;
    bool ever_up_ = false;
    Time up_since_{};
    bool tried_v5_ = false;

    Subscriptions subscriptions_;
    Time last_granted_{};  ///< or refused: when the broker was last busy with a subscription
    Outbox outbox_;
    std::map<int, Unacknowledged> unacknowledged_;
    Counters counters_;

    bool closed_ = false;
    bool leaving_ = false;
    std::function<void()> stopped_;
    asio::steady_timer stop_timer_;
};

Client::Impl::Impl(asio::io_context& io, Options options, Handlers handlers)
    : io_(io),
      options_(std::move(options)),
      handlers_(std::move(handlers)),
      backoff_(options_.retry_first, options_.retry_max),
      retry_timer_(io),
      resolver_(io),
      lookup_timer_(io),
      outbox_({options_.max_queued_messages, options_.max_queued_bytes}),
      stop_timer_(io) {
    if (options_.brokers.empty()) options_.brokers.emplace_back();
    for (const auto& address : options_.brokers)
        brokers_.push_back({address});
    if (!options_.random) options_.random = system_random();
    if (options_.client_id.empty()) options_.client_id = "asip-" + random_hex(options_.random, 12);
}

void Client::Impl::attempt() {
    if (silent()) return;
    addresses_.clear();
    boost::system::error_code not_numeric;
    asio::ip::make_address(broker().address.host, not_numeric);
    if (not_numeric) {
        resolve();
        return;
    }
    addresses_ = {broker().address.host};
    connect_next_address();
}

void Client::Impl::resolve() {
    const auto lookup = ++lookups_;
    lookup_timer_.expires_after(options_.connect_timeout);
    lookup_timer_.async_wait([self = shared_from_this(), lookup](const boost::system::error_code& error) {
        if (!error && lookup == self->lookups_) self->look_up_took_too_long();
    });
    resolver_.async_resolve(
        broker().address.host, std::to_string(broker().address.port),
        [self = shared_from_this(), lookup](const boost::system::error_code& error, const auto& results) {
            if (self->silent() || lookup != self->lookups_) return;
            self->lookup_timer_.cancel();
            if (error) {
                self->connection_down({unreachable(self->broker().address, "unknown host")});
                return;
            }
            for (const auto& result : results) {
                self->addresses_.insert(self->addresses_.begin(), result.endpoint().address().to_string());
            }
            self->connect_next_address();
        });
}

void Client::Impl::look_up_took_too_long() {
    if (silent()) return;
    ++lookups_;  // its result comes too late
    resolver_.cancel();
    connection_down({unreachable(broker().address, "the name server does not answer")});
}

void Client::Impl::connect_next_address() {
    const auto host = addresses_.back();
    addresses_.pop_back();
    const bool v5 =
        options_.version == Version::kV5 || (options_.version == Version::kBest && broker().speaks_v5 &&
                                             broker().suspicions < kSuspicionsUntilFallback);
    was_up_ = false;
    tried_v5_ = v5;
    connection_ = std::make_shared<Connection>(io_, options_, broker().address, host, v5, *this);
    connection_->open();
}

void Client::Impl::connection_up(const Connected& connected) {
    was_up_ = ever_up_ = true;
    up_since_ = last_granted_ = Clock::now();
    ++counters_.connects;
    broker().suspicions = broker().unanswered = 0;
    broker().failed_fatally = false;
    subscriptions_.restart();
    send_subscriptions();
    if (!silent() && handlers_.on_connected) handlers_.on_connected(connected);
    flush();
}

void Client::Impl::connection_down(const End& end) {
    connection_.reset();
    requeue_unacknowledged();
    if (stopped_) {
        finish();
        return;
    }
    if (was_up_) {
        was_up_ = false;
        ++counters_.failures;
        // A broker that takes us and throws us out again is not hammered: only a connection that held counts.
        if (Clock::now() - up_since_ >= kHeldLongEnough) backoff_.reset();
        failures_this_round_ = brokers_.size();
        retry(end.failure.kind != Kind::kStalled && end.failure.kind != Kind::kRefused);
        if (handlers_.on_disconnected) handlers_.on_disconnected(end.failure);
        return;
    }
    if (end.failure.kind == Kind::kUnreachable && !addresses_.empty()) {
        connect_next_address();
        return;
    }
    const auto failed = broker_;
    learn(end);
    ++counters_.failures;
    retry(end.version_refused);
    // A version we can go below is no failure anyone should hear of.
    if (end.version_refused && options_.version == Version::kBest) return;
    auto failure = end.failure;
    // A broker that misses our certificate says so in an alert, which its closing of the socket often
    // overtakes.
    if (failure.broker.tls && brokers_[failed].unanswered >= kUnansweredUntilTls) failure.kind = Kind::kTls;
    brokers_[failed].failed_fatally = failure.fatal();
    failure.hopeless = hopeless();
    if (!silent() && handlers_.on_connect_failed) handlers_.on_connect_failed(failure);
}

void Client::Impl::learn(const End& end) {
    broker().unanswered = end.closed_unanswered ? broker().unanswered + 1 : 0;
    if (end.version_refused) broker().speaks_v5 = false;
    // When 3.1.1 fares no better the suspicion was wrong.
    broker().suspicions = end.closed_unanswered && tried_v5_ ? broker().suspicions + 1 : 0;
}

void Client::Impl::retry(bool same_broker_at_once) {
    Duration wait{};
    const bool suspected = options_.version == Version::kBest && broker().suspicions > 0;
    if (!same_broker_at_once && !suspected) broker_ = (broker_ + 1) % brokers_.size();
    // The whole list is tried without waiting, then there is a pause.
    if (++failures_this_round_ >= brokers_.size()) {
        failures_this_round_ = 0;
        wait = backoff_.next(options_.random);
    }
    retry_timer_.expires_after(wait);
    retry_timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
        if (!error) self->attempt();
    });
}

void Client::Impl::message_received(Message message) {
    ++counters_.received;
    if (!silent() && handlers_.on_message) handlers_.on_message(message);
}

void Client::Impl::debug_line(const std::string& line) {
    if (!silent() && handlers_.on_debug) handlers_.on_debug(line);
}

bool Client::Impl::hopeless() const {
    return !ever_up_ && std::all_of(brokers_.begin(), brokers_.end(),
                                    [](const Broker& each) { return each.failed_fatally; });
}

void Client::Impl::subscribe(std::string filter, SubscribeOptions options) {
    subscriptions_.add(filter, options);
    if (connected()) send_subscriptions();
}

void Client::Impl::unsubscribe(const std::string& filter) {
    subscriptions_.remove(filter);
    if (connected()) connection_->unsubscribe(filter);
}

void Client::Impl::send_subscriptions() {
    const auto now = Clock::now();
    for (const auto& [filter, options] : subscriptions_.due(now)) {
        int id = 0;
        if (connection_->subscribe(filter, options, id) == MOSQ_ERR_SUCCESS)
            subscriptions_.sent(id, filter, now);
    }
}

void Client::Impl::subscribe_answered(int id, const std::vector<int>& granted) {
    const auto now = Clock::now();
    last_granted_ = now;
    const int code = granted.empty() ? 0 : granted.front();
    const bool complete_before = subscriptions_.all_granted();
    const auto refusal = subscriptions_.answered(id, code < kFirstErrorCode, now, options_.random);
    if (silent()) return;
    if (!complete_before && subscriptions_.all_granted() && handlers_.on_subscribed)
        handlers_.on_subscribed();
    if (!refusal) return;
    const std::string reason = mosquitto_reason_string(code);
    if (refusal->first && handlers_.on_subscribe_refused)
        handlers_.on_subscribe_refused(refusal->filter, reason + advice_on_topic(refusal->filter));
    if (refusal->give_up && brokers_.size() > 1 && connection_) {
        connection_->fail({Kind::kRefused, broker().address, code,
                           broker().address.describe() + " refuses the subscription to " + refusal->filter +
                               ": " + reason});
    }
}

PublishResult Client::Impl::publish(Message message, Priority priority) {
    if (closed_ || !can_be_published(message)) {
        ++counters_.refused;
        return PublishResult::kRefused;
    }
    if (!outbox_.push(std::move(message), priority)) {
        ++counters_.refused;
        return PublishResult::kRefused;
    }
    flush();
    return outbox_.empty() ? PublishResult::kSent : PublishResult::kQueued;
}

/// libmosquitto's own queue has no bound: it is given the next message only when it has written the one
/// before.
void Client::Impl::flush() {
    while (!outbox_.empty() && connection_ && connection_->ready_to_write() &&
           window_open(outbox_.front().message)) {
        const int error = send(outbox_.pop());
        if (is_connection_error(error)) {
            connection_->fail(closed_by(broker().address, 0));
            break;
        }
    }
    leave_when_sent();
}

int Client::Impl::send(Outbox::Entry entry) {
    int id = 0;
    const int error = connection_->publish(entry.message, id);
    if (is_connection_error(error)) {
        outbox_.put_back(std::move(entry));
    } else if (error != MOSQ_ERR_SUCCESS) {
        ++counters_.rejected;
        debug_line("not published on " + entry.message.topic + ": " + mosquitto_strerror(error));
    } else if (entry.message.qos == 0) {
        ++counters_.published;
    } else {
        unacknowledged_.emplace(id, Unacknowledged{std::move(entry), Clock::now()});
    }
    return error;
}

void Client::Impl::publish_answered(int id, int reason_code) {
    const auto sent = unacknowledged_.find(id);
    if (sent == unacknowledged_.end()) return;  // QoS 0: libmosquitto reports these as well
    const auto topic = std::move(sent->second.entry.message.topic);
    unacknowledged_.erase(sent);
    if (reason_code >= kFirstErrorCode) {
        ++counters_.rejected;
        debug_line("broker rejected what was published on " + topic + ": " +
                   mosquitto_reason_string(reason_code));
        if (!silent() && handlers_.on_publish_denied) {
            handlers_.on_publish_denied(topic, mosquitto_reason_string(reason_code));
        }
    } else {
        ++counters_.published;
        if (!silent() && handlers_.on_published) handlers_.on_published(topic);
    }
    leave_when_sent();
}

void Client::Impl::requeue_unacknowledged() {
    for (auto& [id, sent] : unacknowledged_)
        outbox_.put_back(std::move(sent.entry));
    unacknowledged_.clear();
}

void Client::Impl::tick(Time now) {
    fail_if_stalled(now);
    if (connected()) send_subscriptions();
}

void Client::Impl::fail_if_stalled(Time now) {
    if (options_.ack_timeout == Duration::zero()) return;
    const auto stalled = [&](const char* what) {
        connection_->fail({Kind::kStalled, broker().address, 0, broker().address.describe() + what});
    };
    if (const auto since = subscriptions_.waiting_since()) {
        if (now - *since >= options_.subscribe_timeout) stalled(" does not answer a subscription");
        return;
    }
    for (const auto& [id, sent] : unacknowledged_) {
        if (now - std::max(sent.sent, last_granted_) < options_.ack_timeout) continue;
        stalled(" acknowledges nothing any more");
        return;
    }
}

void Client::Impl::stop(Duration limit, std::function<void()> done) {
    if (stopped_ || closed_) return;
    stopped_ = std::move(done);
    if (!stopped_) stopped_ = [] {};
    retry_timer_.cancel();
    resolver_.cancel();
    lookup_timer_.cancel();
    if (!connected()) {
        asio::post(io_, [self = shared_from_this()] { self->finish(); });
        return;
    }
    // The last part of the time is for the goodbye itself, whatever is still waiting.
    stop_timer_.expires_after(limit * 3 / 4);
    stop_timer_.async_wait([self = shared_from_this(), limit](const boost::system::error_code& error) {
        if (error || self->closed_) return;
        if (self->connection_ && !self->leaving_) self->connection_->goodbye();
        self->leaving_ = true;
        self->stop_timer_.expires_after(limit / 4);
        self->stop_timer_.async_wait([self](const boost::system::error_code& late) {
            if (!late) self->finish();
        });
    });
    flush();
}

void Client::Impl::leave_when_sent() {
    if (!stopped_ || leaving_ || !connected() || !outbox_.empty() || !unacknowledged_.empty()) return;
    leaving_ = true;
    connection_->goodbye();
}

void Client::Impl::finish() {
    if (closed_) return;
    const auto done = std::move(stopped_);
    close();
    if (done) done();
}

void Client::Impl::close() {
    closed_ = true;
    retry_timer_.cancel();
    stop_timer_.cancel();
    resolver_.cancel();
    lookup_timer_.cancel();
    if (connection_) connection_->abandon();
    connection_.reset();
}

Counters Client::Impl::counters() const {
    auto counters = counters_;
    counters.dropped_context = outbox_.dropped();
    counters.queued = outbox_.size();
    counters.queued_bytes = outbox_.bytes();
    counters.unacknowledged = unacknowledged_.size();
    return counters;
}

Client::Client(asio::io_context& io, Options options, Handlers handlers)
    : impl_(std::make_shared<Impl>(io, std::move(options), std::move(handlers))) {}
Client::~Client() {
    impl_->close();
}
void Client::start() {
    impl_->start();
}
void Client::stop(Duration limit, std::function<void()> done) {
    impl_->stop(limit, std::move(done));
}
void Client::set_will(Message will) {
    impl_->set_will(std::move(will));
}
void Client::subscribe(std::string filter, SubscribeOptions options) {
    impl_->subscribe(std::move(filter), options);
}
void Client::unsubscribe(const std::string& filter) {
    impl_->unsubscribe(filter);
}
PublishResult Client::publish(Message message, Priority priority) {
    return impl_->publish(std::move(message), priority);
}
void Client::discard_queued(Priority priority) {
    impl_->discard_queued(priority);
}
bool Client::connected() const {
    return impl_->connected();
}
bool Client::subscribed() const {
    return impl_->subscribed();
}
bool Client::v5() const {
    return impl_->v5();
}
const std::string& Client::client_id() const {
    return impl_->client_id();
}
Counters Client::counters() const {
    return impl_->counters();
}

}  // namespace asip::mqtt
