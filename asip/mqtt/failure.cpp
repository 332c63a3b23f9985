// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/failure.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <array>

namespace asip::mqtt {
namespace {

using Kind = ConnectionFailure::Kind;

constexpr int kV311BadVersion = 1;
constexpr int kV311ServerUnavailable = 3;
constexpr int kV311BadCredentials = 4;
constexpr int kV311NotAuthorised = 5;

/// What may be wrong with a password that a broker does not take: " (...)", or nothing.
std::string hint_at(const std::string& password) {
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    if (password.empty()) return {};
    if (password.find_first_of("\r\n") != std::string::npos) return " (the password has a line end)";
    if (blank(password.back())) return " (the password ends with a blank)";
    if (blank(password.front())) return " (the password begins with a blank)";
    if (mosquitto_validate_utf8(password.data(), static_cast<int>(password.size())) != MOSQ_ERR_SUCCESS)
        return " (the password is no UTF-8: was it written as Latin-1?)";
    return {};
}

bool is_credentials(int code) {
    switch (code) {
        case kV311BadCredentials:
        case kV311NotAuthorised:
        case MQTT_RC_BAD_USERNAME_OR_PASSWORD:
        case MQTT_RC_NOT_AUTHORIZED:
        case MQTT_RC_BANNED:
        case MQTT_RC_BAD_AUTHENTICATION_METHOD:
            return true;
        default:
            return false;
    }
}

std::string words(int code) {
    if (code == kV311ServerUnavailable) return "server unavailable";
    return code < 128 ? mosquitto_connack_string(code) : mosquitto_reason_string(code);
}

std::string user_named(const std::string& user) {
    return user.empty() ? "a connection without user" : "user " + user;
}

std::string who_may_grant(const std::string& role) {
    return "; the administrator of the broker can give credentials that may: asipctl secure add " + role;
}

}  // namespace

bool ConnectionFailure::fatal() const {
    return !may_pass && (kind == Kind::kTls || kind == Kind::kBadCredentials || kind == Kind::kTakenOver);
}

std::string_view name_of(ConnectionFailure::Kind kind) {
    static constexpr std::array<std::string_view, 8> kNames{
        "unreachable", "no-answer", "tls", "bad-credentials", "refused", "taken-over", "stalled", "closed"};
    return kNames.at(static_cast<std::size_t>(kind));
}

std::string denied_text(const std::string& user, const std::string& topic, const std::string& reason,
                        const std::string& role) {
    if (reason != kNotAuthorised) return "the broker refuses what was written to " + topic + ": " + reason;
    return "the broker does not let " + user_named(user) + " write to " + topic + " (" + reason + ")" +
           who_may_grant(role);
}

std::string cut_off_text(const std::string& user, const std::string& topic, const std::string& role) {
    return "the broker closed the connection right after a message on " + topic +
           ": its access rules may not let " + user_named(user) + " write there" + who_may_grant(role);
}

std::string unanswered_text(const std::string& user, const std::string& topic, const std::string& role) {
    if (user.empty()) return {};
    return ", or the broker's access rules do not let " + user_named(user) + " write to " + topic +
           who_may_grant(role);
}

bool is_version_refusal(int connack_code) {
    return connack_code == kV311BadVersion || connack_code == MQTT_RC_UNSUPPORTED_PROTOCOL_VERSION;
}

ConnectionFailure refused_by(const BrokerAddress& broker, int connack_code, const Options& options) {
    if (!is_credentials(connack_code)) {
        return {Kind::kRefused, broker, connack_code,
                broker.describe() + " refused the connection: " + words(connack_code)};
    }
    const std::string whom =
        options.user.empty() ? "a connection without user; ask the administrator of the broker for "
                               "credentials (asipctl secure add) and give them by --credentials"
        : connack_code == MQTT_RC_BANNED ? "user \"" + options.user + "\": banned"
                                         : "user \"" + options.user + "\"" + hint_at(options.password) +
                                               "; check user and password, or ask the administrator of the "
                                               "broker for new ones (asipctl secure)";
    return {Kind::kBadCredentials, broker, connack_code, broker.describe() + " refused " + whom};
}

ConnectionFailure closed_by(const BrokerAddress& broker, int disconnect_code) {
    const auto prefix = broker.describe();
    switch (disconnect_code) {
        case 0:
            return {Kind::kClosed, broker, 0, prefix + " closed the connection"};
        case MQTT_RC_SESSION_TAKEN_OVER:
            return {Kind::kTakenOver, broker, disconnect_code,
                    prefix + ": another client connected with our client id; give each program its own"};
        case MQTT_RC_KEEP_ALIVE_TIMEOUT:
            return {Kind::kStalled, broker, disconnect_code, prefix + " did not hear from us in time"};
        default:
            return {Kind::kClosed, broker, disconnect_code,
                    prefix + " closed the connection: " + mosquitto_reason_string(disconnect_code)};
    }
}

ConnectionFailure tls_failed(const BrokerAddress& broker, const std::string& detail, bool may_pass) {
    ConnectionFailure failure{Kind::kTls, broker, 0,
                              broker.describe() + ": no TLS connection; check the CA, certificate and key" +
                                  (detail.empty() ? "" : " (" + detail + ")")};
    failure.may_pass = may_pass;
    return failure;
}

ConnectionFailure unreachable(const BrokerAddress& broker, const std::string& detail) {
    return {Kind::kUnreachable, broker, 0,
            "cannot reach the broker " + broker.describe() + ": " + detail + "; is it running there?"};
}

}  // namespace asip::mqtt
