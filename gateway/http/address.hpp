// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::gateway::http {

/// Names can lead anywhere, addresses cannot.
bool is_ip_address(std::string_view host);

/// What limits count as one address: of IPv6 the first 64 bits, which one site has; an IPv4 address within
/// IPv6 as IPv4.
std::string network_of(const std::string& address);

}  // namespace asip::gateway::http
