// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/client.hpp"

#include <boost/asio/post.hpp>

#include "asip/mqtt/client_impl.hpp"

namespace asip::mqtt {
namespace {

namespace asio = boost::asio;

Options completed(Options options) {
    if (options.brokers.empty()) options.brokers.emplace_back();
    if (!options.random) options.random = system_random();
    if (options.client_id.empty()) options.client_id = "asip-" + random_hex(options.random, 12);
    return options;
}

std::string own_topic(const Options& options, const char* below = "") {
    if (options.check_delivery == Duration::zero() || options.own_topics.empty()) return {};
    auto topic = options.own_topics + "/" + options.client_id + below;
    return can_be_topic(topic) ? topic : std::string();
}

}  // namespace

Client::Impl::Impl(asio::io_context& io, Options options, Handlers handlers)
    : io_(io),
      options_(completed(std::move(options))),
      handlers_(std::move(handlers)),
      brokers_(options_.brokers, options_.version, Backoff(options_.retry_first, options_.retry_max)),
      retry_timer_(io),
      lookup_(io),
      usable_qos_(options_.qos),
      keepalive_(options_.keepalive),
      client_id_(options_.client_id),
      own_identifier_(client_id_ + "-" + secret_hex(16)),
      identifier_(own_identifier_),
      own_topic_(options_.brokers.size() > 1 ? own_topic(options_) : std::string()),
      still_topic_(own_topic(options_, "/$qos1")),
      delivery_(options_.check_delivery),
      stand_still_(options_.check_standstill),
      outbox_({options_.max_queued_messages, options_.max_queued_bytes}),
      stop_timer_(io) {}

void Client::Impl::stop(Duration limit, std::function<void()> done) {
    if (stopped_ || closed_) return;
    stopped_ = std::move(done);
    if (!stopped_) stopped_ = [] {};
    retry_timer_.cancel();
    lookup_.cancel();
    trial_.reset();  // what waits is sent, and DISCONNECT: no will is published
    if (!connected()) {
        asio::post(io_, [self = shared_from_this()] { self->finish(); });
        return;
    }
    // The last part of the time is for DISCONNECT itself, whatever is still waiting.
    stop_timer_.expires_after(limit * 3 / 4);
    stop_timer_.async_wait([self = shared_from_this(), limit](const boost::system::error_code& error) {
        if (error || self->closed_) return;
        if (self->connection_ && !self->leaving_) {
            self->without_acknowledgements_ = true;  // what waits for those that are missing goes, too
            self->flush();
        }
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
    lookup_.cancel();
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
void Client::retry_in(Duration wait) {
    impl_->retry_in(wait);
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
bool Client::check(std::function<void()> answered) {
    return impl_->check(std::move(answered));
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
