// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/paths.hpp"

#include <algorithm>

namespace asip::gateway::api {
namespace {

std::vector<Pattern> split_patterns() {
    std::vector<Pattern> patterns;
    for (const auto& route : routes()) {
        auto& levels = patterns.emplace_back(Pattern{&route, {}}).levels;
        for (auto rest = route.path; !rest.empty();) {
            rest.remove_prefix(1);
            levels.push_back(rest.substr(0, rest.find('/')));
            rest.remove_prefix(levels.back().size());
        }
    }
    return patterns;
}

bool is_parameter(std::string_view level) {
    return level.starts_with('{');
}

bool take_prefix(Inner& inner, std::size_t levels) {
    auto& segments = inner.request.segments;
    if (segments.size() < levels) return false;
    for (std::size_t i = 0; i < levels; ++i)
        inner.prefix += "/" + segments[i];
    segments.erase(segments.begin(), segments.begin() + static_cast<std::ptrdiff_t>(levels));
    return true;
}

}  // namespace

const std::vector<Pattern>& patterns() {
    static const auto all = split_patterns();
    return all;
}

// From the end: paths that are as long differ there most often.
bool fits(const Pattern& pattern, const std::vector<std::string>& segments) {
    const auto& levels = pattern.levels;
    return levels.size() == segments.size() &&
           std::equal(levels.rbegin(), levels.rend(), segments.rbegin(), [](auto level, const auto& segment) {
               return is_parameter(level) || level == segment;
           });
}

std::map<std::string, std::string, std::less<>> parameters_of(const Pattern& pattern,
                                                              const std::vector<std::string>& segments) {
    std::map<std::string, std::string, std::less<>> path;
    for (std::size_t i = 0; i < segments.size(); ++i)
        if (const auto level = pattern.levels[i]; is_parameter(level))
            path.emplace(level.substr(1, level.size() - 2), segments[i]);
    return path;
}

bool at_root(const http::Request& request, const std::string& base) {
    const bool kiosk = !request.segments.empty() && request.segments[0] == "kiosk";
    return request.is_asterisk() || (base.empty() && !kiosk);
}

std::optional<Inner> inner_of(const http::Request& request, const std::string& base) {
    Inner inner{request, {}, {}};
    const auto& segments = inner.request.segments;
    if (!base.empty() && (segments.empty() || "/" + segments[0] != base || !take_prefix(inner, 1)))
        return std::nullopt;
    if (segments.size() >= 2 && segments[0] == "kiosk") {
        inner.link = segments[1];
        take_prefix(inner, 2);
    }
    return inner;
}

}  // namespace asip::gateway::api
