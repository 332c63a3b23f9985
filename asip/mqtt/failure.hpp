// SPDX-License-Identifier: Apache-2.0
/// The ways in which a connection fails, in words for a person.
#pragma once
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "asip/mqtt/client.hpp"

namespace asip::mqtt {

/// A CONNACK other than success; codes below 128 are of MQTT 3.1.1.
ConnectionFailure refused_by(const BrokerAddress& broker, int connack_code, const Options& options);

/// Code 0: without DISCONNECT.
ConnectionFailure closed_by(const BrokerAddress& broker, int disconnect_code);

ConnectionFailure tls_failed(const BrokerAddress& broker, const std::string& detail, bool may_pass = false);
ConnectionFailure unreachable(const BrokerAddress& broker, const std::string& detail);

/// What it means for the broker is in the members.
struct ConnectionEnd {
    ConnectionFailure failure;
    bool version_refused = false;    ///< the broker does not know this version of MQTT
    bool closed_unanswered = false;  ///< the broker accepted the TCP connection and closed it before CONNACK
};

/// In the words of libmosquitto: access rules deny it.
inline constexpr std::string_view kNotAuthorised = "Not authorized";

/// For a person whose message was denied: which user, which topic, what helps. `role`: for `asipctl secure
/// add`. Empty `user`: none.
std::string denied_text(const std::string& user, const std::string& topic, const std::string& reason,
                        const std::string& role = "operator NAME");
/// The broker gave no reason, and closed the connection right after the message.
std::string cut_off_text(const std::string& user, const std::string& topic,
                         const std::string& role = "operator NAME");
/// About a message of QoS 0 on `topic` without an answer, since brokers refuse it silently. Empty where
/// `user` is.
std::string unanswered_text(const std::string& user, const std::string& topic,
                            const std::string& role = "operator NAME");

/// The broker does not know this version of the protocol.
bool is_version_refusal(int connack_code);

/// Which failures of an outage are logged: each kind once, since attempts repeat every few seconds.
class Outage {
  public:
    /// This broker has not failed so since over().
    bool is_news(const ConnectionFailure& failure) {
        return seen_.emplace(failure.broker.describe(), failure.kind).second;
    }
    /// A connection is established.
    void over() { seen_.clear(); }

  private:
    std::set<std::pair<std::string, ConnectionFailure::Kind>> seen_;
};

}  // namespace asip::mqtt
