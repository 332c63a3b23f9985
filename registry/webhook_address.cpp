// SPDX-License-Identifier: Apache-2.0
#include "registry/webhook_address.hpp"

#include <algorithm>

namespace asip::registry {

Expected<WebhookAddress> parse_webhook(const std::string& url) {
    const auto scheme = url.find("://");
    const auto path = scheme == std::string::npos ? scheme : url.find_first_of("/?", scheme + 3);
    auto address = text::parse_http_address(url.substr(0, path));
    if (!address) return fail(address.error());
    if (address->host.find('@') != std::string::npos)
        return fail(
            "a name and a password before the host are not sent; put a key into the path or the query");
    auto target = path == std::string::npos ? std::string("/") : url.substr(path);
    if (target.front() == '?') target.insert(0, "/");
    target.resize(std::min(target.size(), target.find('#')));
    if (std::any_of(target.begin(), target.end(),
                    [](unsigned char byte) { return byte <= ' ' || byte >= 127; }))
        return fail("the path of the address has a character that must be written as %XX");
    return WebhookAddress{std::move(*address), std::move(target)};
}

}  // namespace asip::registry
