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

/// Where a broker is, and whether the connection is encrypted.
struct BrokerAddress {
    std::string host = "127.0.0.1";  ///< a name, or an address without brackets
    std::uint16_t port = 1883;
    bool tls = false;

    std::string describe() const;  ///< as a URL, `mqtt://127.0.0.1:1883`
    friend bool operator==(const BrokerAddress&, const BrokerAddress&) = default;
};

/// Reads `HOST`, `HOST:PORT`, `[V6]:PORT`, `mqtt://HOST[:PORT]` (1883) or `mqtts://HOST[:PORT]` (TLS, 8883).
/// Fails for anything else with a reason that names the text.
Expected<BrokerAddress> parse_broker(std::string_view text);

/// Which version of MQTT is spoken.
enum class Version {
    kBest,  ///< 5, and 3.1.1 with a broker that refuses it
    kV5,
    kV311,
};

/// How a client connects, and its bounds.
struct Options {
    static constexpr std::uint32_t kMaxPacketBytes = 2u << 20;

    std::vector<BrokerAddress> brokers{BrokerAddress{}};  ///< at least one; tried in turn
    /// The name of this client, unique for each process; empty: made up. The name is published, in reply
    /// topics for example. Brokers end the older of two connections with the same identifier. The identifier
    /// that a broker sees is therefore the name with 64 random bits behind it, which no program publishes.
    /// Where there are several brokers, the bits are others on each connection (see Identifier).
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
    /// An attempt without a CONNACK after this long is given up: a dead host, or a broker that hangs.
    Duration connect_timeout = std::chrono::seconds(5);
    /// A broker that leaves a QoS 1 message unacknowledged for this long has stalled: the connection is
    /// dropped and the next broker tried. The time stands still while the broker delivers retained messages:
    /// a million of them may be in its queue before an acknowledgement. Zero: left to the keep-alive.
    Duration ack_timeout = std::chrono::seconds(8);
    /// The same for a subscription without an answer. While a subscription has no answer the broker is busy
    /// with it, and ack_timeout stands still.
    Duration subscribe_timeout = std::chrono::seconds(30);
    /// A host that acknowledges for this long nothing of what TCP sends to it is cut off: the connection is
    /// dropped and the next broker tried. Zero: left to the keep-alive.
    Duration unreceived_timeout = std::chrono::seconds(5);
    /// The broker delivers no larger packets to us (MQTT 5; on 3.1.1 only the broker's own limit holds). This
    /// bounds our memory against every client that may publish. It must be clearly above the limit of the
    /// broker, 1 MiB in our configurations: Mosquitto takes a message that is too large for a subscriber, and
    /// never frees the place that this message has among the 20 of QoS 1 that may be on their way to the
    /// subscriber. 0: no limit.
    std::uint32_t max_packet_bytes = kMaxPacketBytes;
    /// What a message on this topic can be of use for, in bytes of its payload; empty: everything. Of a
    /// longer payload one byte more than that is copied, so that whoever reads it finds it too long, at no
    /// cost. Asked for payloads above kShortPayload only.
    std::function<std::size_t(std::string_view topic)> longest_payload{};
    static constexpr std::size_t kShortPayload = 4096;
    /// How often this client looks whether the broker still delivers messages of QoS 1 (MQTT 5, see
    /// StandStill). Zero: never.
    Duration check_standstill = std::chrono::seconds(60);
    /// Where it looks: `own_topics`/CLIENT_ID/$qos1, which this client may write and read and no other client
    /// uses. Empty: never.
    std::string own_topics;
    /// Waiting time between attempts, see Backoff.
    Duration retry_first = std::chrono::milliseconds(100);
    Duration retry_max = std::chrono::seconds(2);

    /// Bounds of what waits to be sent, in messages and in Message::bytes(). Beyond them the oldest context
    /// values are dropped; announcements and replies may fill twice as much before they are refused.
    std::size_t max_queued_messages = 4096;
    std::size_t max_queued_bytes = 4u << 20;

    /// Whether what the broker sends is acknowledged at once, see asip/quick_ack.hpp.
    bool quick_ack = true;

    /// libmosquitto's own log goes to Handlers::on_debug, too. It costs some 1,500 instructions a packet.
    bool packet_log = false;

    /// Whether the broker knows our user, and may have rules for it.
    bool has_user() const { return !user.empty() || !cert_file.empty(); }

    std::optional<Message> will;  ///< published by the broker when the connection is lost
    Random random;                ///< empty: system_random()
};

/// The first line of a file, without its line end: where passwords are kept. Error: the file cannot be read,
/// or is empty.
Expected<std::string> read_password_file(const std::string& path);

}  // namespace asip::mqtt
