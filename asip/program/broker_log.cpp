// SPDX-License-Identifier: Apache-2.0
#include "asip/program/broker_log.hpp"

#include "asip/program/log.hpp"
#include "asip/program/service_manager.hpp"

namespace asip::program {

void BrokerLog::connected(const mqtt::Connected& connected) {
    outage_.over();
    patience_.reset();
    tell_service_manager("STATUS=connected to " + connected.broker.describe());
    log::info("connected", {{"broker", connected.broker.describe()}, {"mqtt", connected.v5 ? "5" : "3.1.1"}});
}

bool BrokerLog::connect_failed(const mqtt::ConnectionFailure& failure,
                               const std::function<void(Duration)>& retry_in) {
    const bool news = outage_.is_news(failure);
    const auto level = failure.hopeless ? log::Level::kError
                       : news           ? log::Level::kWarning
                                        : log::Level::kDebug;
    const bool goes_on = failure.hopeless && supervised();
    log::write(level,
               goes_on            ? "no broker accepts the connection; asking again in a minute or more"
               : failure.hopeless ? "no broker accepts the connection"
                                  : "no connection; trying again",
               {{"broker", failure.broker.describe()}, {"why", failure.text}});
    tell_service_manager("STATUS=no connection to a broker: " + failure.text);
    if (goes_on) retry_in(patience_.next(system_random()));
    return failure.hopeless && !goes_on;
}

void BrokerLog::subscribe_refused(const std::string& filter, const std::string& reason) {
    log::error("the broker refuses a subscription; check its access rules",
               {{"filter", filter}, {"reason", reason}});
}

}  // namespace asip::program
