// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::mqtt {

struct BrokerAddress {
    std::string host = "127.0.0.1";  ///< a name, or an address without brackets
    std::uint16_t port = 1883;
    bool tls = false;

    std::string describe() const;  ///< as a URL, `mqtt://127.0.0.1:1883`
    friend bool operator==(const BrokerAddress&, const BrokerAddress&) = default;
};

/// `HOST`, `HOST:PORT`, `[V6]:PORT`, `mqtt://HOST[:PORT]` (1883) or `mqtts://HOST[:PORT]` (TLS, 8883). Fails
/// with a reason that names the text.
Expected<BrokerAddress> parse_broker(std::string_view text);

enum class Version {
    kBest,  ///< 5, and 3.1.1 with a broker that refuses it
    kV5,
    kV311,
};

/// How a client connects, and its bounds.
struct Options {
    static constexpr std::uint32_t kMaxPacketBytes = 2u << 20;

    std::vector<BrokerAddress> brokers{BrokerAddress{}};  ///< at least one; tried in turn
    /// Unique for each process; empty: made up. It is published, in reply topics for example, and brokers end
    /// the older of two connections with one identifier; so the identifier is this name with 64 random bits
    /// behind it (see Identifier).
    std::string client_id;
    std::string user;
    std::string password;

    std::string ca_file;    ///< PEM; empty: the system's certificates (see Tls)
    std::string cert_file;  ///< PEM; empty: no client certificate
    std::string key_file;
    bool insecure = false;  ///< TLS that accepts any certificate of the broker

    Version version = Version::kBest;
    /// At least 5 s.
    std::chrono::seconds keepalive{10};
    /// Without a CONNACK: a dead host, or a broker that hangs.
    Duration connect_timeout = std::chrono::seconds(5);
    /// With an unacknowledged QoS 1 message for so long the broker has stalled, and the next one is tried.
    /// The time stands still while the broker delivers retained messages, of which a million may go first.
    /// Zero: left to the keep-alive.
    Duration ack_timeout = std::chrono::seconds(8);
    /// The same for a subscription, during which ack_timeout stands still.
    Duration subscribe_timeout = std::chrono::seconds(30);
    /// The same for a host whose TCP acknowledges nothing. Zero: left to the keep-alive.
    Duration unreceived_timeout = std::chrono::seconds(5);
    /// The broker delivers no larger packets (MQTT 5), which bounds our memory. It must be clearly above the
    /// broker's limit, 256 KiB in our configurations: Mosquitto takes a message that is too large for a
    /// subscriber, and never frees its place among those of QoS 1. It may be lower where all subscriptions
    /// have QoS 0. 0: no limit.
    std::uint32_t max_packet_bytes = kMaxPacketBytes;
    /// So many messages of QoS 1 may the broker send to this client before it gets an acknowledgement (MQTT
    /// 5). Further ones wait in the broker's queue. With the usual 20, Mosquitto sends 20 in the time in
    /// which it reads thousands of a flood, and the message of another sender waits seconds behind them. The
    /// largest messages in that number are 50 MB at the broker.
    static constexpr int kReceiveMaximum = 200;
    /// The longest payload of use on a topic; empty: any. Of a longer one a byte more is copied, so that its
    /// reader finds it too long. Asked above kShortPayload only.
    std::function<std::size_t(std::string_view topic)> longest_payload{};
    static constexpr std::size_t kShortPayload = 4096;
    /// See Backoff.
    Duration retry_first = std::chrono::milliseconds(100);
    Duration retry_max = std::chrono::seconds(2);

    /// Bounds of what waits to be sent, in messages and in Message::bytes(). Beyond, the oldest context
    /// values are dropped; announcements and replies may take twice as much.
    std::size_t max_queued_messages = 4096;
    std::size_t max_queued_bytes = 4u << 20;

    /// The client reads at most once in this time, so that many messages wake it only once. It suits messages
    /// that may come late. Zero: the client reads each message as it comes.
    Duration gather{};

    /// See asip/quick_ack.hpp.
    bool quick_ack = true;

    /// libmosquitto's log goes to Handlers::on_debug, at some 1,500 instructions a packet.
    bool packet_log = false;

    /// The broker knows our user, and may have rules for it.
    bool has_user() const { return !user.empty() || !cert_file.empty(); }

    std::optional<Message> will;  ///< published by the broker when the connection is lost
    Random random;                ///< empty: system_random()
};

/// Where passwords are kept. Error: the file cannot be read, or is empty.
Expected<std::string> read_password_file(const std::string& path);

}  // namespace asip::mqtt
