// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/dialect.hpp"

#include <charconv>
#include <cmath>

#include "asip/text/printable.hpp"

namespace asip::gateway::exports {

std::vector<std::string> Dialect::watched() const {
    auto result = retained(place());
    result.push_back(base() + "/+");
    result.push_back(base() + "/+/+");
    return result;
}

std::optional<Dialect::Command> Dialect::command_below(std::string_view begin, std::string_view topic) {
    constexpr std::string_view kEnd = "/set";
    if (!topic.starts_with(begin) || !topic.ends_with(kEnd)) return std::nullopt;
    topic.remove_prefix(begin.size());
    if (topic.size() <= kEnd.size()) return std::nullopt;
    topic.remove_suffix(kEnd.size());
    const auto slash = topic.find('/');
    if (slash == std::string_view::npos || topic.find('/', slash + 1) != std::string_view::npos)
        return std::nullopt;
    return Command{std::string(topic.substr(0, slash)), std::string(topic.substr(slash + 1))};
}

Unexpected<std::string> not_taken(const Property& property, std::string_view payload) {
    return fail(property.name + " cannot be set to " + text::printable(payload, kShownBytes));
}

std::optional<double> number_from(std::string_view text) {
    double value = 0;
    const auto* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::string room_for(std::size_t properties) {
    constexpr std::size_t kUsualBytes = 512, kUsualBytesOfEntity = 256;
    std::string text;
    text.reserve(kUsualBytes + properties * kUsualBytesOfEntity);
    return text;
}

}  // namespace asip::gateway::exports
