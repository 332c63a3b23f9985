// SPDX-License-Identifier: Apache-2.0
#include "asip/client/pending_calls.hpp"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace asip::client {

void PendingCalls::begin(Id id) {
    calls_.insert_or_assign(id, std::make_shared<Call>(executor_));
}

Awaitable<nlohmann::json> PendingCalls::wait(Id id, Duration limit, std::string late) {
    const auto found = calls_.find(id);
    const auto call = found == calls_.end() ? std::make_shared<Call>(executor_) : found->second;
    auto outcome = co_await wait_for(call, limit, std::move(late));
    calls_.erase(id);
    co_return outcome;
}

void PendingCalls::finish(Id id, Outcome outcome) {
    const auto found = calls_.find(id);
    if (found != calls_.end() && !found->second->outcome) {
        found->second->outcome = std::move(outcome);
        found->second->timer.cancel();
    }
}

void PendingCalls::finish_all(const Error& error) {
    for (const auto& [id, call] : calls_) {
        if (!call->outcome) {
            call->outcome = Unexpected<Error>(error);
            call->timer.cancel();
        }
    }
}

Awaitable<nlohmann::json> PendingCalls::wait_for(std::shared_ptr<Call> call, Duration limit,
                                                 std::string late) {
    call->timer.expires_after(limit);
    while (!call->outcome && Clock::now() < call->timer.expiry()) {
        boost::system::error_code woken;
        co_await call->timer.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, woken));
    }
    co_return call->outcome ? std::move(*call->outcome) : failure(Error::Kind::kTimeout, std::move(late));
}

}  // namespace asip::client
