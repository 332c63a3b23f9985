// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::text {

/// `http://HOST[:PORT][/PATH]` or `https://...`.
struct HttpAddress {
    bool tls = false;
    std::string host;  ///< without brackets
    std::string port;  ///< "80", "443" where none was said
    std::string path;  ///< of a server behind a proxy, without a slash at the end; may be empty

    std::string text() const;         ///< as an address again
    std::string host_header() const;  ///< what a request says of the server: `host`, `host:8080`,
                                      ///< `[::1]:8080`
};
/// The error holds no password.
Expected<HttpAddress> parse_http_address(std::string_view text);

}  // namespace asip::text
