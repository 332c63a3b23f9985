// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "asip/mqtt/client.hpp"

namespace asip::caller {

/// What is known of the connection and of the access rules of its broker, from how messages ended: brokers of
/// MQTT 5 say that they deny a message of QoS 1, others say nothing, or close the connection behind it.
class Access {
  public:
    Access(std::string user, std::string role) : user_(std::move(user)), role_(std::move(role)) {}

    /// A message was published.
    void sent(const std::string& topic) { last_topic_ = topic; }
    /// One that wants an answer. `silent`: a broker that denies it does not say so.
    void asked(const std::string& topic, bool silent);
    void connected() { why_lost_.reset(); }
    void disconnected(const mqtt::ConnectionFailure& why);

    /// There was a connection, and there is none: why.
    const std::optional<std::string>& why_lost() const { return why_lost_; }
    /// The connection ends again and again right behind messages of ours.
    bool denies() const { return denies_; }
    /// Topic of the last message; empty: none.
    const std::string& last_topic() const { return last_topic_; }

    /// "the broker does not let ann write to ...".
    std::string denied_text(const std::string& topic, const std::string& reason) const;
    /// Behind a sentence that nothing answered: what the access rules may have to do with it. Empty: nothing.
    std::string may_be_denied() const;

  private:
    /// As what `asipctl secure` is to add the user.
    std::string role_for(const std::string& topic) const;

    std::string user_, role_;
    std::string last_topic_;
    std::optional<std::string> denied_in_silence_;  // the last question may have been
    std::optional<std::string> cut_off_by_;         // right behind a message on this topic it was closed
    std::optional<std::string> why_lost_;
    bool denies_ = false;
};

}  // namespace asip::caller
