// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

#include "asip/mqtt/backoff.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/mqtt/failure.hpp"

namespace asip::program {

/// What a program logs of its connection: each kind of failure once per outage, the rest at level debug.
class BrokerLog {
  public:
    void connected(const mqtt::Connected& connected);
    /// True: no broker accepts this program, which should end with kExitBroker. A supervised one asks again
    /// by `retry_in`, 30 s to 5 min apart.
    bool connect_failed(const mqtt::ConnectionFailure& failure,
                        const std::function<void(Duration)>& retry_in);
    static void subscribe_refused(const std::string& filter, const std::string& reason);

  private:
    mqtt::Outage outage_;
    mqtt::Backoff patience_{std::chrono::minutes(1), std::chrono::minutes(5)};
};

}  // namespace asip::program
