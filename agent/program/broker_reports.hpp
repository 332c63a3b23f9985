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

/// Tells people what is wrong between this agent and its broker: each fault once, in words that say what to
/// do. Keeps what has been said; reads no clock.
class BrokerReports {
  public:
    /// What the sentences name.
    struct Agent {
        std::string board;
        std::string topic_root;
        std::string user;  ///< at the broker; empty: none
        std::string broker;
    };

    /// `log` must outlive it. `agent` is called when there is something to say.
    BrokerReports(BoardLog& log, std::function<Agent()> agent) : log_(log), agent_(std::move(agent)) {}

    // Each is called with what the MQTT client reports, in its order.
    void connected(const mqtt::Connected& connected, const mqtt::Counters& counters);
    /// Each attempt may fail the same way; it is said once.
    void failed(const mqtt::ConnectionFailure& failure, bool was_connected);
    void subscription_refused(const std::string& filter, const std::string& reason);
    /// This machine has credentials for boards, but none for this board.
    void credentials_missing(const std::string& board, const std::string& folder);
    /// The broker took an announcement. True: the first one over this connection.
    bool announced();
    /// The broker may have refused something of this connection: looks what, and says it.
    void look_for_rejections(const mqtt::Counters& counters);
    /// The broker ended the connection each time when it was given an announcement.
    void announcing_denied();
    /// What the broker said of the message that it refused last. Before look_for_rejections().
    void denied(const std::string& reason) { denial_ = reason; }
    /// A request names a topic on which this agent does not answer. Once for each connection.
    void stray_answer(const std::string& topic);
    /// Values and answers that were dropped since the last call.
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
