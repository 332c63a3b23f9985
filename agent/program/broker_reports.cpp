// SPDX-License-Identifier: Apache-2.0
#include "agent/program/broker_reports.hpp"

#include <utility>

#include "asip/mqtt/failure.hpp"

namespace asip::agent {

namespace log = program::log;

void BrokerReports::connected(const mqtt::Connected& connected, const mqtt::Counters& counters) {
    outage_.over();
    if (announcing_ == Announcing::kTaken) announcing_ = Announcing::kTrying;
    stray_answers_ = StrayAnswers::kNone;
    at_connection_ = counters;
    packet_limit_ = connected.max_packet_bytes;
    log_.info("broker connected",
              {{"broker", connected.broker.describe()}, {"mqtt", connected.v5 ? "5" : "3.1.1"}});
}

void BrokerReports::failed(const mqtt::ConnectionFailure& failure, bool was_connected) {
    // Each attempt may fail the same way; once is enough for a person, the rest is for debugging.
    const auto level = was_connected || outage_.is_news(failure) ? log::Level::kWarning : log::Level::kDebug;
    log_.write(level, was_connected ? "broker lost; connecting again" : "broker not reachable; trying on",
               {{"broker", failure.broker.describe()}, {"why", failure.text}});
}

void BrokerReports::subscription_refused(const std::string& filter, const std::string& reason) {
    log_.error("the broker refuses a subscription; asking again", {{"topic", filter}, {"why", reason}});
}

void BrokerReports::credentials_missing(const std::string& board, const std::string& folder) {
    if (std::exchange(credentials_, Credentials::kMissing) == Credentials::kMissing) return;
    log_.warning("there are no credentials for board " + board +
                     " on this machine; waiting for them: sudo asipctl secure add board " + board + " --here",
                 {{"folder", folder}});
}

bool BrokerReports::announced() {
    return std::exchange(announcing_, Announcing::kTaken) != Announcing::kTaken;
}

void BrokerReports::look_for_rejections(const mqtt::Counters& counters) {
    if (!at_connection_) return;
    const auto refused = counters.rejected - at_connection_->rejected;
    const bool too_large = counters.too_large > at_connection_->too_large;
    if (refused == 0 && !too_large) return;
    at_connection_.reset();
    if (too_large) {
        log_.error("a message of this agent is larger than the broker takes; raise its limit",
                   {{"board", agent_().board}, {"broker's limit", packet_limit_}, {"why", denial_}});
        return;
    }
    if (announcing_ != Announcing::kTaken) return announcing_denied();
    log_.warning("the broker refuses some of what this agent publishes; look at its access control",
                 {{"board", agent_().board}, {"refused", refused}, {"why", denial_}});
}

void BrokerReports::announcing_denied() {
    if (announcing_ != Announcing::kTrying) return;
    announcing_ = Announcing::kDenied;
    const auto [board, root, user, broker] = agent_();
    if (!denial_.empty() && denial_ != mqtt::kNotAuthorised) {
        log_.error("the broker refuses the announcement of board " + board + "; no program finds it",
                   {{"why", denial_}, {"broker", broker}});
        return;
    }
    log_.error(
        "the broker's access control denied announcing board " + board + "; no program finds it. " +
            (user.empty() ? "A connection without user" : "User " + user) + " must be allowed to write " +
            root + "/servicebus/$probe, " + root + "/servicebus/" + board + "/# and " + root + "/" + board +
            "/#. On a secured bus a board's user is called like the board: ask the administrator of the "
            "broker for credentials (asipctl secure add board " +
            board + ")" + (user.empty() ? "" : ", or call the board " + user + " (--name " + user + ")"),
        {{"user", user}, {"broker", broker}});
}

void BrokerReports::stray_answer(const std::string& topic) {
    if (std::exchange(stray_answers_, StrayAnswers::kReported) == StrayAnswers::kReported) return;
    const auto agent = agent_();
    log_.warning(
        "a request names a topic for its answer on which this agent does not answer. Where the broker knows "
        "its users, that is below " +
            agent.topic_root + "/reply/USER/" + agent.board + "/",
        {{"topic", topic.substr(0, 200)}});
}

void BrokerReports::look_for_drops(const mqtt::Counters& counters) {
    if (std::exchange(dropped_context_, counters.dropped_context) != counters.dropped_context)
        log_.warning(
            "more values wait for the broker than are kept (it is slow, or away); oldest values dropped",
            {{"dropped", counters.dropped_context}});
    if (std::exchange(dropped_answers_, counters.refused) != counters.refused)
        log_.warning(
            "more waits for the broker than is kept (it is slow, or away); answers or announcements dropped",
            {{"dropped", counters.refused}});
}

}  // namespace asip::agent
