// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "asip/mqtt/backoff.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/mqtt/options.hpp"

namespace asip::mqtt {

/// Which broker is tried next, when, and with which version of MQTT: decided from how the attempts before
/// ended. Pure.
class BrokerList {
  public:
    /// What follows from the end of an attempt or a connection.
    struct Next {
        Duration wait{};  ///< before the next attempt
        /// To be reported; nothing when only the version of MQTT was too high.
        std::optional<ConnectionFailure> failure;
    };

    /// `brokers` is not empty.
    BrokerList(std::vector<BrokerAddress> brokers, Version version, Backoff backoff);

    /// The one to try now.
    const BrokerAddress& current() const { return brokers_[current_].address; }
    std::size_t size() const { return brokers_.size(); }
    /// Its place in the list.
    std::size_t place() const { return current_; }
    /// Whether to try it with MQTT 5: not where another broker of the list said that it does not know it.
    /// They are of one kind, and at a busy one an attempt in vain takes as long as the other.
    bool with_v5() const;

    /// It accepted the connection.
    void accepted();
    /// The accepted connection ended after `held`. Of a list, the next attempt is at once if that was long;
    /// if it was short for the third time in a row, it is at the next broker.
    Next lost(const ConnectionEnd& end, Duration held, const Random& random);
    /// The attempt failed. `tried_v5`: what with_v5() was.
    Next failed(const ConnectionEnd& end, bool tried_v5, const Random& random);

  private:
    struct Broker {
        BrokerAddress address;
        bool supports_v5 = true;
        bool took_v5 = false;         ///< it accepted a connection with it
        int suspicions = 0;           ///< attempts with MQTT 5 in a row that were closed without an answer
        int silences = 0;             ///< attempts with MQTT 5 in a row that met silence
        int unanswered = 0;           ///< attempts in a row, with any version, that had no answer
        bool failed_fatally = false;  ///< the last time
    };

    void learn(Broker& broker, const ConnectionEnd& end, bool tried_v5) const;
    Duration advance(bool same_broker_at_once, const Random& random);
    bool hopeless() const;

    std::vector<Broker> brokers_;
    Version version_;
    Backoff backoff_;
    std::size_t current_ = 0;
    std::size_t failures_this_round_ = 0;
    int closed_soon_ = 0;  ///< connections in a row that this broker ended as soon as it had accepted them
    bool ever_accepted_ = false;
    bool refused_v5_ = false;      ///< one of the list that was accepted with 3.1.1 then
    int accepted_without_v5_ = 0;  ///< behind attempts with MQTT 5 that had no answer
};

}  // namespace asip::mqtt
