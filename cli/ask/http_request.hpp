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

/// How requests are made.
struct HttpAccess {
    std::string token;  ///< sent as a bearer token; empty: none
    std::string ca;     ///< file with the certificates to trust; empty: those of the system
    std::chrono::milliseconds limit{5000};
};

/// GETs `target` below the address. Error: a sentence; at most the limit has passed.
Expected<HttpAnswer> http_get(const HttpAddress& address, const std::string& target,
                              const HttpAccess& access);
/// POSTs `{}` as JSON.
Expected<HttpAnswer> http_post(const HttpAddress& address, const std::string& target,
                               const HttpAccess& access);

}  // namespace asip::cli
