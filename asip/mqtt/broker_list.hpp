// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "asip/mqtt/backoff.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/mqtt/quirks/knows_no_mqtt_5.hpp"

namespace asip::mqtt {

/// Decides from ended attempts which broker is tried next, when, and with which version of MQTT. Pure.
class BrokerList {
  public:
    struct Next {
        Duration wait{};  ///< before the next attempt
        /// None: only the version of MQTT was too high.
        std::optional<ConnectionFailure> failure;
    };

    /// Not empty.
    BrokerList(std::vector<BrokerAddress> brokers, Version version, Backoff backoff);

    const BrokerAddress& current() const { return brokers_[current_].address; }
    std::size_t size() const { return brokers_.size(); }
    bool with_v5() const { return brokers_[current_].version.v5(); }

    /// The broker accepted the connection.
    void accepted();
    /// The accepted connection ended after `held`. After a long one the next attempt follows at once where
    /// there are several brokers; after three short ones in a row the next broker is tried.
    Next lost(const ConnectionEnd& end, Duration held, const Random& random);
    /// `tried_v5`: what with_v5() was.
    Next failed(const ConnectionEnd& end, bool tried_v5, const Random& random);

  private:
    struct Broker {
        BrokerAddress address;
        VersionChoice version;
        int unanswered = 0;           ///< attempts in a row, with any version, that had no answer
        bool failed_fatally = false;  ///< the last time
    };

    Duration advance(bool same_broker_at_once, const Random& random);
    bool hopeless() const;

    std::vector<Broker> brokers_;
    Version version_;
    Backoff backoff_;
    std::size_t current_ = 0;
    std::size_t failures_this_round_ = 0;
    int closed_soon_ = 0;  ///< connections in a row that this broker ended as soon as it had accepted them
    bool ever_accepted_ = false;
};

}  // namespace asip::mqtt
