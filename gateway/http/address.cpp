// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/address.hpp"

#include <arpa/inet.h>

#include <algorithm>

namespace asip::gateway::http {

bool is_ip_address(std::string_view host) {
    const std::string text(host);
    unsigned char ignored[sizeof(in6_addr)];
    return inet_pton(AF_INET, text.c_str(), ignored) == 1 || inet_pton(AF_INET6, text.c_str(), ignored) == 1;
}

std::string network_of(const std::string& address) {
    constexpr std::ptrdiff_t kNetworkBytes = 8;
    in6_addr bytes{};
    const auto plain = address.substr(0, address.find('%'));  // without the interface of a link-local one
    if (plain.find(':') == std::string::npos || inet_pton(AF_INET6, plain.c_str(), &bytes) != 1)
        return address;
    char text[INET6_ADDRSTRLEN] = "";
    if (IN6_IS_ADDR_V4MAPPED(&bytes)) return inet_ntop(AF_INET, &bytes.s6_addr[12], text, sizeof text);
    std::fill(std::begin(bytes.s6_addr) + kNetworkBytes, std::end(bytes.s6_addr), std::uint8_t{0});
    return std::string(inet_ntop(AF_INET6, &bytes, text, sizeof text)) + "/64";
}

}  // namespace asip::gateway::http
