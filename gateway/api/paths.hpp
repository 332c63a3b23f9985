// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gateway/api/routes.hpp"

namespace asip::gateway::api {

/// A route's path in its levels: taken apart once, since each request is compared with many.
struct Pattern {
    const Route* route;
    std::vector<std::string_view> levels;
};
/// The patterns of all routes.
const std::vector<Pattern>& patterns();
bool fits(const Pattern& pattern, const std::vector<std::string>& segments);
/// The parameters in a path that fits.
std::map<std::string, std::string, std::less<>> parameters_of(const Pattern& pattern,
                                                              const std::vector<std::string>& segments);

/// A request as it is behind the prefixes of its path.
struct Inner {
    http::Request request;
    std::string prefix;               ///< "/asip/kiosk/TOKEN"
    std::optional<std::string> link;  ///< the token of a kiosk's link
};
/// Its path has no prefix. `base`: of a proxy, "/asip"; empty: none.
bool at_root(const http::Request& request, const std::string& base);
/// Nothing: it is not below the base path.
std::optional<Inner> inner_of(const http::Request& request, const std::string& base);

}  // namespace asip::gateway::api
