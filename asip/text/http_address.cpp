// SPDX-License-Identifier: Apache-2.0
#include "asip/text/http_address.hpp"

#include <charconv>

#include "asip/text/printable.hpp"

namespace asip::text {

std::string HttpAddress::host_header() const {
    const auto name = host.find(':') == std::string::npos ? host : "[" + host + "]";
    return port == (tls ? "443" : "80") ? name : name + ":" + port;
}

std::string HttpAddress::text() const {
    return (tls ? "https://" : "http://") + host_header() + path;
}

Expected<HttpAddress> parse_http_address(std::string_view text) {
    HttpAddress address;
    const auto wrong =
        fail("\"" + without_credentials(text) + "\" is not an address such as http://127.0.0.1:8080");
    if (text.starts_with("https://"))
        address.tls = true;
    else if (!text.starts_with("http://"))
        return wrong;
    text.remove_prefix(address.tls ? 8 : 7);
    const auto slash = text.find('/');
    if (slash != std::string_view::npos) address.path = text.substr(slash);
    while (!address.path.empty() && address.path.back() == '/')
        address.path.pop_back();
    auto authority = text.substr(0, slash);
    const auto bracket = authority.find(']');
    const auto colon = authority.find(':', bracket == std::string_view::npos ? 0 : bracket);
    address.port = colon == std::string_view::npos ? (address.tls ? "443" : "80")
                                                   : std::string(authority.substr(colon + 1));
    authority = authority.substr(0, colon);
    if (bracket != std::string_view::npos && authority.front() == '[')
        authority = authority.substr(1, authority.size() - 2);
    address.host = authority;
    unsigned port = 0;
    const auto* const end = address.port.data() + address.port.size();
    const auto [read, fault] = std::from_chars(address.port.data(), end, port);
    const bool is_port = fault == std::errc{} && read == end && port >= 1 && port <= 65535;
    if (address.host.empty() || !is_port || text.find_first_of(" \r\n\t?#") != std::string_view::npos)
        return wrong;
    return address;
}

}  // namespace asip::text
