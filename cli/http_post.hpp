// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::cli {

/// `http://HOST[:PORT][/PATH]` or `https://...`, taken apart.
struct HttpAddress {
    bool tls = false;
    std::string host;  ///< without brackets
    std::string port;  ///< "80", "443" where none was said
    std::string path;  ///< of a gateway behind a proxy, without a slash at the end; may be empty

    std::string text() const;  ///< as an address again
};
/// Error: a sentence.
Expected<HttpAddress> parse_http_address(std::string_view text);

struct HttpAnswer {
    int status = 0;
    std::string body;
};

/// POSTs `{}` as JSON to `target` below the address. `token`: sent as a bearer token; empty: none. TLS trusts
/// the system's certificates, or those in the file `ca`. Error: a sentence; at most `limit` has passed.
Expected<HttpAnswer> http_post(const HttpAddress& address, const std::string& target,
                               const std::string& token, const std::string& ca,
                               std::chrono::milliseconds limit);

}  // namespace asip::cli
