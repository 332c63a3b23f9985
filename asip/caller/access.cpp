// SPDX-License-Identifier: Apache-2.0
#include "asip/caller/access.hpp"

#include "asip/mqtt/failure.hpp"

namespace asip::caller {

void Access::asked(const std::string& topic, bool silent) {
    sent(topic);
    denied_in_silence_ = silent ? std::optional(topic) : std::nullopt;
}

void Access::disconnected(const mqtt::ConnectionFailure& why) {
    why_lost_ = why.text;
    // Brokers do not say that they denied a message which they do not acknowledge: Mosquitto 2.0.11 closes
    // the connection. One end may be that of the broker itself.
    denies_ = why.after_sending > 1 && !last_topic_.empty();
    if (why.after_sending > 0 && !last_topic_.empty()) cut_off_by_ = last_topic_;
}

std::string Access::role_for(const std::string& topic) const {
    if (!role_.empty()) return role_;
    return topic.ends_with("/query") ? "viewer NAME" : "operator NAME";
}

std::string Access::denied_text(const std::string& topic, const std::string& reason) const {
    return mqtt::denied_text(user_, topic, reason, role_for(topic));
}

std::string Access::may_be_denied() const {
    // It came back without an answer: a broker that only restarted is the rarer reason.
    if (cut_off_by_) return "; " + mqtt::cut_off_text(user_, *cut_off_by_, role_for(*cut_off_by_));
    if (!denied_in_silence_) return {};
    return mqtt::unanswered_text(user_, *denied_in_silence_, role_for(*denied_in_silence_));
}

}  // namespace asip::caller
