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
    /// The failure may pass by itself: a certificate that is not valid yet, by our clock.
    bool may_pass = false;
    /// Every broker of the list has failed fatally, and none has ever accepted a connection: a program should
    /// stop and report it. The client itself tries on.
    bool hopeless = false;
    /// How many connections in a row, this one included, were closed without a reason soon after a message of
    /// ours: access rules may have denied it.
    unsigned after_sending = 0;

    /// Whether trying this broker again cannot help until a user changes something: kTls, kBadCredentials or
    /// kTakenOver, unless it may pass.
    bool fatal() const;
};

/// One word for logs and statistics: "unreachable", "tls", ... Static storage.
std::string_view name_of(ConnectionFailure::Kind kind);

/// An accepted connection.
struct Connected {
    BrokerAddress broker;
    bool v5 = false;                   ///< false: 3.1.1, and properties are not carried
    std::string client_id;             ///< the name of this client: Options::client_id
    std::size_t max_packet_bytes = 0;  ///< the broker's limit; 0: it named none
};

/// What publish() did. How a message of QoS 1 ends that is kSent or kQueued is reported by on_published or
/// on_publish_denied, unless it is dropped from the queue or expires, which is counted.
enum class PublishResult {
    kSent,     ///< handed to the socket
    kQueued,   ///< waits: not connected, or the broker is slower than we are
    kRefused,  ///< queue full of messages that may not be dropped, or MQTT cannot carry topic or payload
};

/// Counted since construction, except where "now" stands.
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

/// One connection to a bus, kept up: connects, and after any loss connects again, to the next broker of the
/// list with jittered backoff, subscribes to everything again, and sends what was queued. Messages of QoS 1
/// arrive at least once: one that was not acknowledged is sent again over the next connection.
///
/// Runs on the io_context it is given, on the one thread that runs it; every handler is called from there,
/// never from inside a call of one of the member functions. Handlers may call any member function, but must
/// not destroy the client. Host names are looked up without blocking; a lookup that takes longer than
/// Options::connect_timeout counts as unreachable.
class Client {
  public:
    struct Handlers {
        /// The connection is accepted and subscriptions are sent: what is published from here on reaches us,
        /// too. Announce and probe here.
        std::function<void(const Connected&)> on_connected;
        /// An established connection was lost; the next attempt is under way.
        std::function<void(const ConnectionFailure&)> on_disconnected;
        /// An attempt failed; the next is under way.
        std::function<void(const ConnectionFailure&)> on_connect_failed;
        /// A message of a subscription. Valid during the call only.
        std::function<void(const Message&)> on_message;
        /// The broker acknowledged this QoS 1 message. Where QoS 0 is used in its place: it was handed over.
        std::function<void(const std::string& topic)> on_published;
        /// The broker refuses this subscription: access rules, or a broker in trouble. Called for the first
        /// refusal on a connection. The subscription is tried again (1 s to 30 s apart); after three refusals
        /// of a required one the client tries the next broker of the list.
        std::function<void(const std::string& filter, const std::string& reason)> on_subscribe_refused;
        /// Why a message was not published, and with Options::packet_log each line of libmosquitto's own log.
        std::function<void(const std::string& line)> on_debug;
        /// All required subscriptions are granted; where none is required, all. Called after on_connected,
        /// and again whenever the last missing one is granted.
        std::function<void()> on_subscribed;
        /// The broker denied this QoS 1 message: access rules, quota. It is not sent again. MQTT 5 only:
        /// on 3.1.1 brokers deny in silence.
        std::function<void(const std::string& topic, const std::string& reason)> on_publish_denied{};
    };

    /// Handlers that are empty are not called. `io` must outlive the client.
    Client(boost::asio::io_context& io, Options options, Handlers handlers);
    /// Drops the connection without DISCONNECT: the broker publishes the will.
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// Begins to connect. Call once.
    void start();
    /// From Handlers::on_connect_failed: the next attempt is so much later, in place of what was planned.
    void retry_in(Duration wait);

    /// Sends what is queued, sends DISCONNECT (no will is published) and calls `done` within `limit`, also
    /// when the broker hangs or there is no connection. Nothing else is called afterwards.
    void stop(Duration limit, std::function<void()> done);

    /// Replaces the will from the next connection on.
    void set_will(Message will);

    /// Adds a subscription, now and on each reconnection; the same filter again replaces its options.
    void subscribe(std::string filter, SubscribeOptions options = {});
    /// Messages that are under way may still arrive.
    void unsubscribe(const std::string& filter);

    /// Asks the broker for an answer that comes in order with messages: the broker wrote whatever is received
    /// behind the answer after this call. (It is the answer to UNSUBSCRIBE of a filter that the client never
    /// subscribed to.) `answered` is called once, or never if the connection ends before. False: not
    /// connected, or the check before has no answer yet.
    bool check(std::function<void()> answered);

    /// Publishes, or queues in order. Of retained messages that wait, the newest of a topic replaces the
    /// older. May be called before start(), and while there is no connection. `priority` decides what is
    /// dropped first when the queue is full; of the order only that Priority::kUrgent leaves ahead of all.
    /// A message with expiry_seconds that is not retained is dropped and counted when it waited, or was not
    /// acknowledged, for so long, or for less than a second less; also on 3.1.1, where brokers do not know of
    /// it.
    PublishResult publish(Message message, Priority priority = Priority::kContext);

    /// Forgets what is queued and not yet handed over, for a program that announces anew on each connection.
    void discard_queued(Priority priority);

    bool connected() const;
    /// Connected, and all required subscriptions are granted; where none is required, all.
    bool subscribed() const;
    /// Whether the present connection is MQTT 5; false while there is none.
    bool v5() const;
    /// The name of this client: as in the options, or made up.
    const std::string& client_id() const;
    Counters counters() const;

    class Impl;

  private:
    std::shared_ptr<Impl> impl_;
};

}  // namespace asip::mqtt
