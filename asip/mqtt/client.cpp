// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/client.hpp"

#include <mosquitto.h>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

#include "asip/mqtt/client_core.hpp"
#include "asip/mqtt/connection.hpp"
#include "asip/mqtt/host_lookup.hpp"

namespace asip::mqtt {
namespace {

namespace asio = boost::asio;

constexpr const char* kCheckFilter = "$check";

}  // namespace

/// Gives the core what happens, and performs its actions. Lives until its last asynchronous operation has
/// ended.
class Client::Impl final : public ConnectionEvents, public std::enable_shared_from_this<Impl> {
  public:
    Impl(asio::io_context& io, Options options, Handlers handlers)
        : io_(io),
          core_(std::move(options), [] { return secret_hex(16); }),
          options_(core_.options()),
          handlers_(std::move(handlers)),
          lookup_(io),
          timer_(io) {}

    ClientCore& core() { return core_; }
    Actions& actions() { return actions_; }

    /// Performs the actions of a call of the program, but for what handlers are told: that is done from the
    /// io_context.
    void perform_now() { perform(false); }
    void stop(Duration limit, std::function<void()> done);
    bool check(std::function<void()> answered);
    void close();

  private:
    void connection_up(const Connected& connected) override;
    void connection_down(const ConnectionEnd& end) override;
    void message_received(Message message) override;
    void publish_answered(int id, int reason_code) override;
    void subscribe_answered(int id, const std::vector<int>& granted) override;
    void unsubscribe_answered(int id) override;
    void may_write() override;
    void tick(Time now) override;
    void debug_line(const std::string& line) override;

    void perform(bool tells);
    static bool tells_the_program(const action::Action& action);
    void wake_up();
    void connect_next_address();
    void end_connection();
    template <class Handler, class... Arguments>
    void tell(const Handler& handler, const Arguments&... arguments) {
        if (!stopped_ && !closed_ && handler) handler(arguments...);
    }

    void perform(action::Connect& action);
    void perform(action::Subscribe& action);
    void perform(action::Unsubscribe& action) {
        int id = 0;
        if (connection_) connection_->unsubscribe(action.filter, id);
    }
    void perform(action::Check& action);
    void perform(action::Publish& action);
    void perform(action::Goodbye&) {
        if (connection_) connection_->goodbye();
    }
    void perform(action::Fail& action) {
        if (connection_) connection_->fail(std::move(action.failure));
    }
    void perform(action::Abandon&) { end_connection(); }
    void perform(action::Established& action) { tell(handlers_.on_connected, action.connected); }
    void perform(action::Lost& action) { tell(handlers_.on_disconnected, action.failure); }
    void perform(action::AttemptFailed& action) { tell(handlers_.on_connect_failed, action.failure); }
    void perform(action::Published& action) { tell(handlers_.on_published, action.topic); }
    void perform(action::PublishDenied& action) {
        tell(handlers_.on_publish_denied, action.topic, action.reason);
    }
    void perform(action::Subscribed&) { tell(handlers_.on_subscribed); }
    void perform(action::SubscribeRefused& action) {
        tell(handlers_.on_subscribe_refused, action.filter, action.reason);
    }
    void perform(action::CheckAnswered&) { tell(std::exchange(check_answered_, nullptr)); }
    void perform(action::Debug& action) { tell(handlers_.on_debug, action.line); }
    void perform(action::Stopped& action);

    asio::io_context& io_;
    ClientCore core_;
    Options options_;  ///< of the connection
    Handlers handlers_;
    Actions actions_;  ///< the first `performed_` are done
    std::size_t performed_ = 0;
    bool performing_ = false;

    HostLookup lookup_;
    action::Connect attempt_;
    std::vector<std::string> addresses_;  ///< of the attempt, those not yet tried; the next one last
    std::shared_ptr<Connection> connection_;
    asio::steady_timer timer_;
    std::optional<Time> wake_up_at_;

    std::function<void()> check_answered_;
    std::function<void()> stopped_;
    bool closed_ = false;
};

// Handlers call member functions of the client: what follows from these calls is performed behind what was
// decided before.
void Client::Impl::perform(bool tells) {
    if (std::exchange(performing_, true)) return;
    const auto self = shared_from_this();
    while (performed_ < actions_.size() && !closed_) {
        if (!tells && tells_the_program(actions_[performed_])) {
            asio::post(io_, [self] { self->perform(true); });
            break;
        }
        auto action = std::move(actions_[performed_++]);
        std::visit([this](auto& each) { perform(each); }, action);
    }
    performing_ = false;
    if (performed_ == actions_.size() || closed_) {
        actions_.clear();
        performed_ = 0;
    }
    wake_up();
}

bool Client::Impl::tells_the_program(const action::Action& action) {
    return action.index() >= action::Action(action::Established{}).index();
}

void Client::Impl::wake_up() {
    const auto due = closed_ ? std::nullopt : core_.next_deadline();
    if (due == wake_up_at_) return;
    wake_up_at_ = due;
    timer_.cancel();
    if (!due) return;
    timer_.expires_at(*due);
    timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
        if (error || self->closed_) return;
        self->wake_up_at_.reset();
        self->tick(Clock::now());
    });
}

void Client::Impl::perform(action::Connect& action) {
    attempt_ = std::move(action);
    addresses_.clear();
    lookup_.start(
        attempt_.broker, options_.connect_timeout,
        [self = shared_from_this()](Expected<std::vector<std::string>> addresses) {
            if (self->closed_) return;
            if (!addresses)
                return self->connection_down({unreachable(self->attempt_.broker, addresses.error())});
            self->addresses_ = std::move(*addresses);
            self->connect_next_address();
        });
}

void Client::Impl::connect_next_address() {
    const auto host = addresses_.back();
    addresses_.pop_back();
    options_.will = attempt_.will;
    options_.client_id = attempt_.client_id;
    connection_ = std::make_shared<Connection>(io_, options_, attempt_.broker, host, attempt_.v5, *this);
    connection_->open();
}

void Client::Impl::perform(action::Subscribe& action) {
    int id = 0;
    const bool sent =
        connection_ && connection_->subscribe(action.filter, action.options, id) == MOSQ_ERR_SUCCESS;
    core_.subscribe_sent(action.filter, sent ? std::optional(id) : std::nullopt, Clock::now());
}

void Client::Impl::perform(action::Check&) {
    int id = 0;
    const bool sent = connection_ && connection_->unsubscribe(kCheckFilter, id) == MOSQ_ERR_SUCCESS;
    core_.check_sent(sent ? std::optional(id) : std::nullopt);
}

void Client::Impl::perform(action::Publish&) {
    if (!connection_) return;
    int id = 0;
    const int error = connection_->publish(core_.to_send(), id);
    core_.publish_sent(error, id, connection_->ready_to_write(), Clock::now(), actions_);
}

void Client::Impl::perform(action::Stopped&) {
    const auto done = std::move(stopped_);
    close();
    if (done) done();
}

void Client::Impl::stop(Duration limit, std::function<void()> done) {
    if (stopped_ || closed_) return;
    stopped_ = done ? std::move(done) : [] {};
    core_.stop(limit, Clock::now(), actions_);
    perform_now();
}

bool Client::Impl::check(std::function<void()> answered) {
    if (!core_.check(actions_)) return false;
    check_answered_ = std::move(answered);
    perform_now();
    return true;
}

void Client::Impl::close() {
    closed_ = true;
    timer_.cancel();
    end_connection();
}

void Client::Impl::end_connection() {
    lookup_.cancel();
    if (connection_) connection_->abandon();
    connection_.reset();
}

void Client::Impl::connection_up(const Connected& connected) {
    addresses_.clear();
    core_.connection_up({connected, connection_->max_qos(), connection_->receive_maximum()}, Clock::now(),
                        actions_);
    perform(true);
}

void Client::Impl::connection_down(const ConnectionEnd& end) {
    connection_.reset();
    if (end.failure.kind == ConnectionFailure::Kind::kUnreachable && !addresses_.empty())
        return connect_next_address();
    core_.connection_down(end, Clock::now(), actions_);
    perform(true);
}

void Client::Impl::message_received(Message message) {
    perform(true);
    if (core_.message_received(message, Clock::now())) tell(handlers_.on_message, message);
}

void Client::Impl::publish_answered(int id, int reason_code) {
    core_.publish_answered(id, reason_code, Clock::now(), actions_);
    perform(true);
}

void Client::Impl::subscribe_answered(int id, const std::vector<int>& granted) {
    core_.subscribe_answered(id, granted, Clock::now(), actions_);
    perform(true);
}

void Client::Impl::unsubscribe_answered(int id) {
    core_.unsubscribe_answered(id, actions_);
    perform(true);
}

void Client::Impl::may_write() {
    core_.may_write(Clock::now(), actions_);
    perform(true);
}

void Client::Impl::tick(Time now) {
    core_.tick(connection_ && connection_->has_unread(), now, actions_);
    perform(true);
}

void Client::Impl::debug_line(const std::string& line) {
    tell(handlers_.on_debug, line);
}

Client::Client(asio::io_context& io, Options options, Handlers handlers)
    : impl_(std::make_shared<Impl>(io, std::move(options), std::move(handlers))) {}
Client::~Client() {
    impl_->close();
}
void Client::start() {
    impl_->core().start(impl_->actions());
    impl_->perform_now();
}
void Client::retry_in(Duration wait) {
    impl_->core().retry_in(wait, Clock::now());
    impl_->perform_now();
}
void Client::stop(Duration limit, std::function<void()> done) {
    impl_->stop(limit, std::move(done));
}
void Client::set_will(Message will) {
    impl_->core().set_will(std::move(will));
}
void Client::subscribe(std::string filter, SubscribeOptions options) {
    impl_->core().subscribe(filter, options, Clock::now(), impl_->actions());
    impl_->perform_now();
}
void Client::unsubscribe(const std::string& filter) {
    impl_->core().unsubscribe(filter, impl_->actions());
    impl_->perform_now();
}
bool Client::check(std::function<void()> answered) {
    return impl_->check(std::move(answered));
}
PublishResult Client::publish(Message message, Priority priority) {
    const auto result = impl_->core().publish(std::move(message), priority, Clock::now(), impl_->actions());
    impl_->perform_now();
    return result;
}
void Client::discard_queued(Priority priority) {
    impl_->core().discard_queued(priority);
}
bool Client::connected() const {
    return impl_->core().connected();
}
bool Client::subscribed() const {
    return impl_->core().subscribed();
}
bool Client::v5() const {
    return impl_->core().v5();
}
const std::string& Client::client_id() const {
    return impl_->core().options().client_id;
}
Counters Client::counters() const {
    return impl_->core().counters();
}

}  // namespace asip::mqtt
