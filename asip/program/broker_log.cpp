// SPDX-License-Identifier: Apache-2.0
#include "asip/program/broker_log.hpp"

#include "asip/program/log.hpp"

namespace asip::program {

void BrokerLog::connected(const mqtt::Connected& connected) {
    outage_.over();
    log::info("connected", {{"broker", connected.broker.describe()}, {"mqtt", connected.v5 ? "5" : "3.1.1"}});
}

bool BrokerLog::connect_failed(const mqtt::ConnectionFailure& failure) {
    const bool news = outage_.is_news(failure);
    const auto level = failure.hopeless ? log::Level::kError
                       : news           ? log::Level::kWarning
                                        : log::Level::kDebug;
    log::write(level, failure.hopeless ? "no broker accepts the connection" : "no connection; trying again",
               {{"broker", failure.broker.describe()}, {"why", failure.text}});
    return failure.hopeless;
}

void BrokerLog::subscribe_refused(const std::string& filter, const std::string& reason) {
    log::error("the broker refuses a subscription; check its access rules",
               {{"filter", filter}, {"reason", reason}});
}

}  // namespace asip::program
