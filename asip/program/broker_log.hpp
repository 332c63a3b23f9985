// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/mqtt/client.hpp"
#include "asip/mqtt/outage.hpp"

namespace asip::program {

/// What a program that serves the bus logs of its connection to the broker: each kind of failure once per
/// outage, further attempts at level debug only.
class BrokerLog {
  public:
    void connected(const mqtt::Connected& connected);
    /// True: no broker of the list accepts this program, so that it should end with kExitBroker.
    bool connect_failed(const mqtt::ConnectionFailure& failure);
    static void subscribe_refused(const std::string& filter, const std::string& reason);

  private:
    mqtt::Outage outage_;
};

}  // namespace asip::program
