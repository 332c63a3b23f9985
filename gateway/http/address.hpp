// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::gateway::http {

/// Whether it is an IP address: names can be made to lead anywhere, addresses cannot.
bool is_ip_address(std::string_view host);

/// What limits count as one address. Of IPv6 the first 64 bits, which one site has ("2001:db8:1:2::/64"); an
/// IPv4 address within IPv6 as IPv4. Any other text as it is.
std::string network_of(const std::string& address);

}  // namespace asip::gateway::http
