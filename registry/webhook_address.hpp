// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/expected.hpp"
#include "asip/text/http_address.hpp"

namespace asip::registry {

/// An address of http or https, taken apart.
struct WebhookAddress {
    text::HttpAddress server;  ///< without a path
    std::string target;        ///< path and query: "/hook?key=1"
    std::string user;          ///< NAME:PASSWORD, sent by Basic; empty: none
};
/// Fails with a sentence that has nothing of what may be secret.
Expected<WebhookAddress> parse_webhook(const std::string& url);

}  // namespace asip::registry
