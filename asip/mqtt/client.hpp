// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "asip/mqtt/message.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/mqtt/subscriptions.hpp"
#include "asip/time.hpp"

namespace boost::asio {
class io_context;
}

namespace asip::mqtt {

/// Why there is no connection.
struct ConnectionFailure {
    enum class Kind {
        kUnreachable,     ///< no TCP connection: refused, no route, unknown host, or no answer in time
        kNoAnswer,        ///< TCP connected, but no answer: the broker hangs, or is something else
        kTls,             ///< certificates: theirs or ours
        kBadCredentials,  ///< the broker refused user, password or client certificate, or bans us
        kRefused,         ///< the broker refused for another reason
        kTakenOver,       ///< another client connected with our client id
        kStalled,         ///< an established connection went silent (keep-alive, or acknowledgements overdue)
        kClosed,          ///< an established connection was closed by the broker or the network
    };
    Kind kind = Kind::kUnreachable;
    BrokerAddress broker{};
    int code = 0;        ///< reason code of CONNACK or DISCONNECT, where there was one
    std::string text{};  ///< one line for a person, with what to check
    /// For example, a certificate is not valid yet, by our clock.
    bool may_pass = false;
    /// Every broker failed fatally, and none has ever accepted: a program should stop and report it. The
    /// client tries on.
    bool hopeless = false;
    /// How many connections in a row were closed without a reason soon after a message of ours: access rules
    /// may deny it.
    unsigned after_sending = 0;

    /// Only a user can change it: kTls, kBadCredentials or kTakenOver, unless it may pass.
    bool fatal() const;
};

/// For logs and statistics: "unreachable", "tls", ...
std::string_view name_of(ConnectionFailure::Kind kind);

struct Connected {
    BrokerAddress broker;
    bool v5 = false;                   ///< false: 3.1.1, and properties are not carried
    std::string client_id;             ///< the name of this client: Options::client_id
    std::size_t max_packet_bytes = 0;  ///< the broker's limit; 0: it named none
};

/// The end of a QoS 1 message that is kSent or kQueued is told by on_published or on_publish_denied, unless
/// it was dropped or expired, which is counted.
enum class PublishResult {
    kSent,     ///< handed to the socket
    kQueued,   ///< waits: not connected, or the broker is slower than we are
    kRefused,  ///< queue full of messages that may not be dropped, or MQTT cannot carry topic or payload
};

/// Since construction, except where "now" stands.
struct Counters {
    std::uint64_t published = 0;  ///< QoS 0: handed over; QoS 1: acknowledged
    std::uint64_t received = 0;
    std::uint64_t dropped_context = 0;  ///< oldest context values that were dropped from a full queue
    std::uint64_t refused = 0;          ///< publish() returned kRefused
    std::uint64_t expired = 0;          ///< not sent, because their time was over: see publish()
    std::uint64_t rejected = 0;         ///< acknowledged by the broker with an error (not authorised, quota)
    std::uint64_t too_large = 0;        ///< not sent, because this broker takes no packet as large (MQTT 5)
    std::uint64_t connects = 0;         ///< accepted connections
    std::uint64_t failures = 0;         ///< failed attempts and lost connections
    std::size_t queued = 0;             ///< now
    std::size_t queued_bytes = 0;       ///< now
    std::size_t unacknowledged = 0;     ///< now: sent with QoS 1 and not acknowledged
};

/// A connection to a bus, kept up: after any loss it connects again, to the next broker of the list with
/// jittered backoff, subscribes again, and sends what was queued. Messages of QoS 1 arrive at least once.
/// Runs on one io_context and thread. Handlers are called from there, never from inside a member function;
/// they may call any member function, and must not destroy the client. Host names are looked up without
/// blocking, within Options::connect_timeout.
class Client {
  public:
    struct Handlers {
        /// Subscriptions are sent, so what is published from here on reaches us, too. Announce and probe
        /// here.
        std::function<void(const Connected&)> on_connected;
        /// The next attempt is under way.
        std::function<void(const ConnectionFailure&)> on_disconnected;
        /// The next attempt is under way.
        std::function<void(const ConnectionFailure&)> on_connect_failed;
        /// Valid during the call only.
        std::function<void(const Message&)> on_message;
        /// The broker acknowledged a QoS 1 message, or got it where QoS 0 is used instead.
        std::function<void(const std::string& topic)> on_published;
        /// The broker refuses a subscription; called once a connection. It is tried again (1 s to 30 s
        /// apart); after three refusals of a required one the client tries the next broker.
        std::function<void(const std::string& filter, const std::string& reason)> on_subscribe_refused;
        /// Why a message was not published, and with Options::packet_log each line of libmosquitto's log.
        std::function<void(const std::string& line)> on_debug;
        /// All required subscriptions are granted, or all where none is required. Behind on_connected, and
        /// again whenever the last missing one is granted.
        std::function<void()> on_subscribed;
        /// The broker denied a QoS 1 message (rules, quota), which is not sent again. MQTT 5 only: 3.1.1
        /// brokers deny in silence.
        std::function<void(const std::string& topic, const std::string& reason)> on_publish_denied{};
    };

    /// Empty handlers are not called.
    Client(boost::asio::io_context& io, Options options, Handlers handlers);
    /// Without DISCONNECT: the broker publishes the will.
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// Call once.
    void start();
    /// From Handlers::on_connect_failed: when the next attempt is.
    void retry_in(Duration wait);

    /// Sends what is queued and DISCONNECT (no will is published), and calls `done` within `limit`, whatever
    /// the broker does. Nothing else is called afterwards.
    void stop(Duration limit, std::function<void()> done);

    /// From the next connection on.
    void set_will(Message will);

    /// For this and all later connections; the same filter again replaces its options.
    void subscribe(std::string filter, SubscribeOptions options = {});
    /// Messages under way may still arrive.
    void unsubscribe(const std::string& filter);

    /// Asks the broker for an answer in order with messages: what is received behind it was written after
    /// this call. (It answers UNSUBSCRIBE of an unknown filter.) `answered` is called once, or never if the
    /// connection ends before. False: not connected, or the check before has no answer yet.
    bool check(std::function<void()> answered);

    /// Publishes, or queues in order; of waiting retained messages the newest of a topic stays. Works before
    /// start() and without a connection. `priority` decides what a full queue drops first; only
    /// Priority::kUrgent changes the order. A message with expiry_seconds that is not retained is dropped and
    /// counted when it waited for so long, also on 3.1.1.
    PublishResult publish(Message message, Priority priority = Priority::kContext);

    /// For a program that announces anew on each connection.
    void discard_queued(Priority priority);

    bool connected() const;
    /// Connected, with all required subscriptions, or all where none is required.
    bool subscribed() const;
    /// False while there is no connection.
    bool v5() const;
    /// As in the options, or made up.
    const std::string& client_id() const;
    Counters counters() const;

    class Impl;

  private:
    std::shared_ptr<Impl> impl_;
};

}  // namespace asip::mqtt
