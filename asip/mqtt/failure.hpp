// SPDX-License-Identifier: Apache-2.0
/// Distinguishes the ways in which a connection fails, in words for a person.
#pragma once
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "asip/mqtt/client.hpp"

namespace asip::mqtt {

/// A CONNACK other than success. Codes below 128 are those of MQTT 3.1.1.
ConnectionFailure refused_by(const BrokerAddress& broker, int connack_code, const Options& options);

/// The broker sent DISCONNECT, or ended the connection without it (code 0).
ConnectionFailure closed_by(const BrokerAddress& broker, int disconnect_code);

/// `may_pass`: the reason may pass by itself.
ConnectionFailure tls_failed(const BrokerAddress& broker, const std::string& detail, bool may_pass = false);
ConnectionFailure unreachable(const BrokerAddress& broker, const std::string& detail);

/// How a connection or an attempt to connect ended, and what that means for the broker.
struct ConnectionEnd {
    ConnectionFailure failure;
    bool version_refused = false;    ///< the broker does not know this version of MQTT
    bool closed_unanswered = false;  ///< the broker accepted the TCP connection and closed it before CONNACK
};

/// The reason, in the words of libmosquitto, for what access rules deny.
inline constexpr std::string_view kNotAuthorised = "Not authorized";

/// The text for a person whose message the broker denied: which user, which topic, and how to get the right.
/// `role`: what `asipctl secure add` should make of the user. Empty `user`: none.
std::string denied_text(const std::string& user, const std::string& topic, const std::string& reason,
                        const std::string& role = "operator NAME");
/// The same where the broker gave no reason, and closed the connection right after the message.
std::string cut_off_text(const std::string& user, const std::string& topic,
                         const std::string& role = "operator NAME");
/// What may be said of a message with QoS 0 on `topic` that got no answer: a broker refuses it without a
/// word. Empty where `user` is.
std::string unanswered_text(const std::string& user, const std::string& topic,
                            const std::string& role = "operator NAME");

/// Whether a CONNACK code means that the broker does not know this version of the protocol.
bool is_version_refusal(int connack_code);

/// Decides which failures of one outage are worth a line in the log. Attempts repeat every few seconds, and
/// fail in the same way each time.
class Outage {
  public:
    /// Whether this broker has not yet failed in this way since over().
    bool is_news(const ConnectionFailure& failure) {
        return seen_.emplace(failure.broker.describe(), failure.kind).second;
    }
    /// Call when a connection is established.
    void over() { seen_.clear(); }

  private:
    std::set<std::pair<std::string, ConnectionFailure::Kind>> seen_;
};

}  // namespace asip::mqtt
