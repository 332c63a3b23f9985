// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>

#include "asip/expected.hpp"
#include "asip/text/http_address.hpp"

namespace asip::cli {

using text::HttpAddress;
using text::parse_http_address;

struct HttpAnswer {
    int status = 0;
    std::string body;
};

struct HttpAccess {
    std::string token;  ///< sent as a bearer token; empty: none
    std::string ca;     ///< file with the certificates to trust; empty: those of the system
    std::chrono::milliseconds limit{5000};
};

/// Error: a sentence; at most the limit has passed.
Expected<HttpAnswer> http_get(const HttpAddress& address, const std::string& target,
                              const HttpAccess& access);
/// POSTs `{}` as JSON.
Expected<HttpAnswer> http_post(const HttpAddress& address, const std::string& target,
                               const HttpAccess& access);

}  // namespace asip::cli
