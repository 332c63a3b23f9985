// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/text/http_address.hpp"

namespace asip::registry {

struct WebhookAddress {
    text::HttpAddress server;  ///< without a path
    std::string target;        ///< path and query: "/hook?key=1"
    std::string user;          ///< NAME:PASSWORD, sent by Basic; empty: none
};
/// %40 as @; nothing: no number follows a %.
std::optional<std::string> percent_decoded(std::string_view text);
/// The head Authorization, behind its first word.
std::string basic(const std::string& user);
/// The error holds no secret.
Expected<WebhookAddress> parse_webhook(const std::string& url);

}  // namespace asip::registry
