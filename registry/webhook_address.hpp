// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/text/http_address.hpp"

namespace asip::registry {

/// An address of http or https, taken apart.
struct WebhookAddress {
    text::HttpAddress server;  ///< without a path
    std::string target;        ///< path and query: "/hook?key=1"
    std::string user;          ///< NAME:PASSWORD, sent by Basic; empty: none
};
/// %40 as @; nothing where what follows a % is no number.
std::optional<std::string> percent_decoded(std::string_view text);
/// As the head Authorization has it behind its first word.
std::string basic(const std::string& user);
/// Fails with a sentence that has nothing of what may be secret.
Expected<WebhookAddress> parse_webhook(const std::string& url);

}  // namespace asip::registry
