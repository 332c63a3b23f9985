// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/board_info.hpp"

namespace asip::protocol {

std::optional<Banner> parse_banner(std::string_view text) {
    constexpr std::string_view kRunning = " running on ";
    constexpr std::string_view kServices = " with Services:";
    if (!text.empty() && text.front() == '!') text.remove_prefix(1);
    const auto running = text.find(kRunning);
    if (running == std::string_view::npos || running == 0) return std::nullopt;
    const auto rest = text.substr(running + kRunning.size());
    const auto services = rest.find(kServices);
    if (services == std::string_view::npos || services == 0) return std::nullopt;

    Banner banner;
    banner.sketch = text.substr(0, running);
    banner.chip = rest.substr(0, services);
    for (const char c : rest.substr(services + kServices.size())) {
        if (c == ' ' || c == '\r') continue;
        if (c < 'A' || c > 'Z') return std::nullopt;
        banner.services += c;
    }
    return banner;
}

}  // namespace asip::protocol
