// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/http/message.hpp"

namespace asip::gateway {

/// Whether a request has a header that only proxies write: Forwarded, X-Forwarded-..., X-Real-IP or Via.
bool came_through_proxy(const http::Request& request);

/// What the proxy nearest to us says of its client.
struct Forwarded {
    std::string address;  ///< an IP address; empty: it says none
    bool secure = false;  ///< the client speaks TLS to it
};
/// Of X-Forwarded-For and X-Forwarded-Proto, else of Forwarded (RFC 7239), the last element counts: that the
/// proxy wrote itself; those before it may be anybody's. Only for requests that do come from a proxy.
Forwarded forwarded_by(const http::Request& request);

}  // namespace asip::gateway
