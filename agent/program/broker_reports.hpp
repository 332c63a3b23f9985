// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "agent/counts/board_log.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/mqtt/failure.hpp"

namespace asip::agent {

/// Tells people what is wrong between agent and broker: each fault once, with what to do.
class BrokerReports {
  public:
    struct Agent {
        std::string board;
        std::string topic_root;
        std::string user;  ///< at the broker; empty: none
        std::string broker;
    };

    /// `agent` is called when there is something to say.
    BrokerReports(BoardLog& log, std::function<Agent()> agent) : log_(log), agent_(std::move(agent)) {}

    // Each is called with what the MQTT client reports, in its order.
    void connected(const mqtt::Connected& connected, const mqtt::Counters& counters);
    /// Failures that repeat are said once.
    void failed(const mqtt::ConnectionFailure& failure, bool was_connected);
    void subscription_refused(const std::string& filter, const std::string& reason);
    /// This machine has credentials for boards, but none for this one.
    void credentials_missing(const std::string& board, const std::string& folder);
    /// The broker took an announcement. True: the first of this connection.
    bool announced();
    /// Says whether the broker may have refused something on this connection.
    void look_for_rejections(const mqtt::Counters& counters);
    /// The broker ended each connection over an announcement.
    void announcing_denied();
    /// The broker's words about its last refusal. Before look_for_rejections().
    void denied(const std::string& reason) { denial_ = reason; }
    /// A request names a topic where this agent does not answer. Once a connection.
    void stray_answer(const std::string& topic);
    /// Since the last call.
    void look_for_drops(const mqtt::Counters& counters);

  private:
    enum class Announcing {
        kTrying,  // over this connection nothing is known yet
        kTaken,   // over this connection
        kDenied,  // and said, until one is taken: a broker may take long to be set right
    };
    enum class Credentials { kExpected, kMissing };
    enum class StrayAnswers { kNone, kReported };  // of this connection

    BoardLog& log_;
    const std::function<Agent()> agent_;
    mqtt::Outage outage_;
    Announcing announcing_ = Announcing::kTrying;
    Credentials credentials_ = Credentials::kExpected;
    StrayAnswers stray_answers_ = StrayAnswers::kNone;
    std::optional<mqtt::Counters> at_connection_;  // none: rejections of this connection were reported
    std::string denial_;
    std::size_t packet_limit_ = 0;       // of this broker, in bytes
    std::uint64_t dropped_context_ = 0;  // as reported last
    std::uint64_t dropped_answers_ = 0;
};

}  // namespace asip::agent
