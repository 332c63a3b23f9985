// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asip/mqtt/broker_list.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/mqtt/connection.hpp"
#include "asip/mqtt/cut_off.hpp"
#include "asip/mqtt/delivery.hpp"
#include "asip/mqtt/host_lookup.hpp"
#include "asip/mqtt/outbox.hpp"
#include "asip/mqtt/stand_still.hpp"
#include "asip/mqtt/usable_qos.hpp"

namespace asip::mqtt {

/// Whether something can be published on it.
bool can_be_topic(const std::string& text);

/// What is behind a Client; lives until its last asynchronous operation has ended.
class Client::Impl final : public ConnectionEvents, public std::enable_shared_from_this<Impl> {
  public:
    Impl(boost::asio::io_context& io, Options options, Handlers handlers);

    void start() { attempt(); }
    void retry_in(Duration wait) { retry_after(wait); }
    void stop(Duration limit, std::function<void()> done);
    void close();

    void set_will(Message will) { options_.will = std::move(will); }
    void subscribe(std::string filter, SubscribeOptions options);
    void unsubscribe(const std::string& filter);
    bool check(std::function<void()> answered);
    PublishResult publish(Message message, Priority priority);
    void discard_queued(Priority priority) { outbox_.discard(priority); }

    bool connected() const { return up() && !trial_; }
    bool subscribed() const { return connected() && subscriptions_.usable(); }
    bool v5() const { return connected() && connection_->v5(); }
    const std::string& client_id() const { return client_id_; }
    Counters counters() const;

  private:
    struct Unacknowledged {
        Outbox::Entry entry;
        Time sent;
        bool superseded = false;  // a newer retained one of its topic was sent with QoS 0
    };
    struct OwnSubscription {
        int id;
        Time sent;
        bool answered = false;
        bool granted = false;
    };
    struct Check {
        int id;
        std::function<void()> answered;
    };

    bool up() const { return connection_ && connection_->up(); }

    // Connecting (client_connecting.cpp)
    void connection_up(const Connected& connected) override;
    void connection_down(const ConnectionEnd& end) override;
    void tick(Time now) override;
    void attempt();
    void connect_next_address();
    bool asks_for_one_first() const;
    bool try_first_subscription(const Connected& connected);
    /// How long a first subscription may take.
    Duration patience() const;
    std::chrono::seconds keepalive() const;
    void begin(Connected connected);
    void retry_after(Duration wait);
    /// When the oldest subscription without an answer was asked for.
    std::optional<Time> subscribing_since() const;
    void fail_if_stalled(Time now);
    /// Whether the broker took what was published then, long ago, and does not acknowledge it.
    bool withheld(Time published, Time now) const;
    void do_without_what_is_withheld(Time now);
    bool checks_delivery() const { return !own_topic_.empty(); }
    void check_delivery(Time now);
    void check_stand_still(Time now);
    bool qos_failed(Duration waited);
    void change_identifier();
    std::string identifier() const;
    /// For how long the oldest message without an acknowledgement has waited for it.
    Duration unacknowledged_for(Time now) const;

    // Subscriptions and messages (client_messages.cpp)
    void message_received(Message message) override;
    void publish_answered(int id, int reason_code) override;
    void subscribe_answered(int id, const std::vector<int>& granted) override;
    void unsubscribe_answered(int id) override;
    void may_write() override { flush(); }
    void debug_line(const std::string& line) override;
    void send_subscriptions();
    std::optional<int> send(const Subscriptions::Sending& due, Time now);
    int send(Outbox::Entry entry);
    void flush();
    void requeue_unacknowledged(Time now);
    void handed_over(std::string topic);
    void supersede(const std::string& topic);
    bool window_open(const Message& message) const;
    int qos_of(const Message& message) const {
        return without_acknowledgements_ ? 0 : usable_qos_.of(message.qos);
    }

    // Stopping (client.cpp)
    /// Handlers are kept, and no longer called: one of them may be what called stop().
    bool silent() const { return closed_ || stopped_; }
    void leave_when_sent();
    void finish();

    boost::asio::io_context& io_;
    Options options_;
    Handlers handlers_;

    BrokerList brokers_;
    boost::asio::steady_timer retry_timer_;
    HostLookup lookup_;
    std::vector<std::string> addresses_;  ///< of this attempt, those not yet tried; the next one last
    std::shared_ptr<Connection> connection_;
    bool was_up_ = false;
    Time up_since_{};
    /// The connection before ended because the broker stood still or could not be reached any more.
    bool left_stalled_ = false;
    /// While the connection is of no use yet: what is to be reported when the broker shows that it works.
    std::optional<Connected> trial_;
    std::optional<int> first_subscription_;  // that was asked for alone, while it has no answer
    bool tried_v5_ = false;
    CutOff cut_off_;
    UsableQos usable_qos_;
    /// The broker delivers and does not acknowledge: QoS 0 is used until it does.
    bool without_acknowledgements_ = false;
    const std::chrono::seconds keepalive_;  // the one that was asked for; see keepalive()
    const std::string client_id_;           // the name, which others know
    const std::string own_identifier_;      // with what nobody knows behind it
    std::string identifier_;                // what is used in its place; see identifier()

    Subscriptions subscriptions_;
    /// When the broker was last busy with a subscription: granted or refused it, or delivered what it
    /// retains.
    Time last_subscribing_{};
    Time last_behind_{};  // when bytes of the broker were not read yet
    std::optional<Check> check_;
    std::string own_topic_;    // empty: delivery is not checked
    std::string still_topic_;  // empty: nobody looks whether QoS 1 stands still
    std::string own_payload_;  // of the last message on it
    std::uint64_t own_messages_ = 0;
    /// None yet on this connection. It is asked for last, when nobody waits for the broker any more: of all
    /// who come from a node that died, at the same moment.
    std::optional<OwnSubscription> own_subscription_;
    Delivery delivery_;
    StandStill stand_still_;
    std::optional<OwnSubscription> stand_still_subscription_;
    Outbox outbox_;
    std::map<int, Unacknowledged> unacknowledged_;
    Counters counters_;

    bool closed_ = false;
    bool leaving_ = false;
    std::function<void()> stopped_;
    boost::asio::steady_timer stop_timer_;
};

}  // namespace asip::mqtt
