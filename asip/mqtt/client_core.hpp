// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "asip/mqtt/broker_list.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/mqtt/outbox.hpp"
#include "asip/mqtt/quirks/acknowledges_late.hpp"
#include "asip/mqtt/quirks/closes_when_denied.hpp"
#include "asip/mqtt/quirks/refuses_qos_1.hpp"
#include "asip/mqtt/quirks/ties_identifiers.hpp"
#include "asip/mqtt/subscriptions.hpp"

/// What a ClientCore has its caller do, or tell the program, in order.
namespace asip::mqtt::action {
/// Ends in connection_up() or connection_down().
struct Connect {
    BrokerAddress broker{};
    bool v5 = true;
    std::string client_id{};
    std::optional<Message> will{};
};
/// Then call subscribe_sent().
struct Subscribe {
    std::string filter;
    SubscribeOptions options{};
};
struct Unsubscribe {
    std::string filter;
};
/// Send UNSUBSCRIBE of an unknown filter, then call check_sent().
struct Check {};
/// Send ClientCore::to_send(), then call publish_sent().
struct Publish {};
/// Send DISCONNECT; connection_down() follows.
struct Goodbye {};
/// End the connection without DISCONNECT; connection_down() follows, with this failure.
struct Fail {
    ConnectionFailure failure;
};
/// End the connection or attempt without DISCONNECT; no call about it follows.
struct Abandon {};
// What the program is told: see Client::Handlers.
struct Established {
    Connected connected;
};
struct Lost {
    ConnectionFailure failure;
};
struct AttemptFailed {
    ConnectionFailure failure;
};
struct Published {
    std::string topic;
};
struct PublishDenied {
    std::string topic;
    std::string reason;
};
struct Subscribed {};
struct SubscribeRefused {
    std::string filter;
    std::string reason;
};
struct CheckAnswered {};
struct Debug {
    std::string line;
};
/// stop() is complete.
struct Stopped {};
using Action = std::variant<Connect, Subscribe, Unsubscribe, Check, Publish, Goodbye, Fail, Abandon,
                            Established, Lost, AttemptFailed, Published, PublishDenied, Subscribed,
                            SubscribeRefused, CheckAnswered, Debug, Stopped>;
}  // namespace asip::mqtt::action

namespace asip::mqtt {

using Actions = std::vector<action::Action>;

bool can_be_topic(const std::string& text);

/// From the broker's CONNACK.
struct Accepted {
    Connected connected;
    int max_qos = 2;                      ///< the highest QoS that the broker takes
    std::size_t receive_maximum = 65535;  ///< how many messages of QoS 1 may be unacknowledged
};

/// All decisions of a Client: which broker, when to connect again, what to send, when a broker is given up.
/// Pure. The caller performs the appended actions in order, and reports what came of them. It calls tick()
/// about once a second while connected, and at next_deadline(). Times do not go back.
class ClientCore {
  public:
    /// `secrets`: see Identifier.
    explicit ClientCore(Options options, Identifier::Secrets secrets);

    // What the program asks for: see Client.
    void start(Actions& out);
    void retry_in(Duration wait, Time now) { retry_at_ = now + wait; }
    void stop(Duration limit, Time now, Actions& out);
    void set_will(Message will) { options_.will = std::move(will); }
    void subscribe(const std::string& filter, SubscribeOptions options, Time now, Actions& out);
    void unsubscribe(const std::string& filter, Actions& out);
    bool check(Actions& out);
    PublishResult publish(Message message, Priority priority, Time now, Actions& out);
    void discard_queued(Priority priority) { outbox_.discard(priority); }

    bool connected() const { return phase_ == Phase::kUp; }
    bool subscribed() const { return connected() && subscriptions_.usable(); }
    bool v5() const { return connected() && v5_; }
    /// With defaults for what was left out.
    const Options& options() const { return options_; }
    Counters counters() const;

    // What became of actions. A packet id that is missing means that the packet could not be sent.
    void subscribe_sent(const std::string& filter, std::optional<int> id, Time now);
    void check_sent(std::optional<int> id);
    /// For action::Publish.
    const Message& to_send() const { return sending_->entry.message; }
    /// `error`: of libmosquitto. `writable`: the next message would go straight to the socket.
    void publish_sent(int error, int id, bool writable, Time now, Actions& out);

    // What happens on the connection.
    void connection_up(const Accepted& accepted, Time now, Actions& out);
    void connection_down(const ConnectionEnd& end, Time now, Actions& out);
    /// A message would go straight to the socket.
    void may_write(Time now, Actions& out);
    /// True: tell the program.
    bool message_received(const Message& message, Time now);
    void publish_answered(int id, int reason_code, Time now, Actions& out);
    void subscribe_answered(int id, const std::vector<int>& granted, Time now, Actions& out);
    void unsubscribe_answered(int id, Actions& out);

    /// `unread`: bytes wait to be read, so this program is slow.
    void tick(bool unread, Time now, Actions& out);
    /// Beside the calls of each second.
    std::optional<Time> next_deadline() const;

  private:
    enum class Phase {
        kIdle,        ///< not started
        kWaiting,     ///< for retry_at_
        kConnecting,  ///< from action::Connect on
        kUp,
        kEnding,  ///< DISCONNECT or action::Fail is under way
        kClosed,  ///< stopped
    };
    struct Sending {
        Outbox::Entry entry;
        int wanted_qos;  ///< before QosLimit
    };
    struct Stop {
        Time hurry_at;  ///< from then on no acknowledgement is waited for
        Time end_at;
    };
    struct PendingCheck {
        std::optional<int> id;
    };

    void attempt(Actions& out);
    void fail(ConnectionFailure::Kind kind, const std::string& what, int code, Actions& out);
    void fail_if_stalled(bool unread, Time now, Actions& out);
    void send_subscriptions(Time now, Actions& out);
    void flush(Time now, Actions& out);
    void put_back_unsent();
    void leave_when_sent(Actions& out);
    void finish(Actions& out);
    bool stopping() const { return stop_.has_value(); }
    bool window_open(const Message& message) const;
    int qos_of(const Message& message) const { return hurries_ ? 0 : qos_limit_.of(message.qos); }
    /// Unless the program has stopped the client.
    void tell(action::Action action, Actions& out) const;

    Options options_;
    BrokerList brokers_;
    Identifier identifier_;
    QosLimit qos_limit_;
    ClosesWhenDenied closes_when_denied_;
    Subscriptions subscriptions_;
    Acknowledgements acknowledgements_;
    Outbox outbox_;
    Counters counters_;

    Phase phase_ = Phase::kIdle;
    Time retry_at_{};
    Time up_since_{};
    bool tried_v5_ = false;
    bool v5_ = false;
    std::size_t receive_maximum_ = 0;
    std::size_t max_packet_bytes_ = 0;  ///< of this broker; 0: it named none
    bool writable_ = false;
    std::optional<Sending> sending_;  ///< while its result is not known
    std::optional<PendingCheck> check_;
    std::optional<Stop> stop_;
    bool hurries_ = false;
};

}  // namespace asip::mqtt
