// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/host_lookup.hpp"

namespace asip::mqtt {

void HostLookup::start(const BrokerAddress& broker, Duration limit, Done done) {
    cancel();
    boost::system::error_code not_numeric;
    boost::asio::ip::make_address(broker.host, not_numeric);
    if (!not_numeric) return done(std::vector<std::string>{broker.host});
    timer_.expires_after(limit);
    timer_.async_wait([this, number = number_, done](const boost::system::error_code& error) {
        if (error || number != number_) return;
        cancel();
        done(fail("the name server does not answer"));
    });
    resolver_.async_resolve(
        broker.host, std::to_string(broker.port),
        [this, number = number_, done](const boost::system::error_code& error, const auto& results) {
            if (number != number_) return;
            cancel();
            if (error) return done(fail("unknown host"));
            std::vector<std::string> addresses;
            for (const auto& result : results)
                addresses.insert(addresses.begin(), result.endpoint().address().to_string());
            done(std::move(addresses));
        });
}

void HostLookup::cancel() {
    ++number_;
    timer_.cancel();
    resolver_.cancel();
}

}  // namespace asip::mqtt
