// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <string>

#include "asip/expected.hpp"
#include "asip/time.hpp"
#include "registry/webhook_address.hpp"
#include "registry/webhook_answer.hpp"

namespace asip::registry {

/// POSTs JSON to one address, one message at a time, without blocking. https trusts the system's
/// certificates.
class Webhook {
  public:
    using Result = WebhookResult;
    /// `wait`: as a verdict has it.
    using Done = std::function<void(Result, const std::string& why, Duration wait)>;

    static constexpr Duration kLimit = std::chrono::seconds(10);  ///< for all of one message

    static Expected<std::unique_ptr<Webhook>> create(boost::asio::io_context& io, const std::string& url);
    ~Webhook();

    /// Calls `done` once, from the io_context; not after the end of this.
    void post(std::string body, Done done);
    /// Without what may be secret: `https://hooks.example`.
    std::string shown() const { return address_.server.text(); }

  private:
    class Exchange;
    Webhook(boost::asio::io_context& io, WebhookAddress address) : io_(io), address_(std::move(address)) {}

    boost::asio::io_context& io_;
    WebhookAddress address_;
    std::shared_ptr<Exchange> exchange_;
};

}  // namespace asip::registry
