// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/machine_names.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "asip/program/options.hpp"
#include "cli/secure/certificate.hpp"

namespace asip::cli {
namespace {

bool is_of_containers(const std::string& interface) {
    constexpr std::array<const char*, 6> kPrefixes{"docker", "br-", "veth", "virbr", "cni", "podman"};
    return std::any_of(kPrefixes.begin(), kPrefixes.end(),
                       [&](const char* prefix) { return interface.starts_with(prefix); });
}

/// An address of any kind, as getifaddrs gives it, as text.
std::string text_of(const sockaddr& address) {
    std::array<char, INET6_ADDRSTRLEN> text{};
    if (address.sa_family == AF_INET) {
        sockaddr_in v4{};
        std::memcpy(&v4, &address, sizeof v4);
        ::inet_ntop(AF_INET, &v4.sin_addr, text.data(), text.size());
    } else if (address.sa_family == AF_INET6) {
        sockaddr_in6 v6{};
        std::memcpy(&v6, &address, sizeof v6);
        if (!IN6_IS_ADDR_LINKLOCAL(&v6.sin6_addr))
            ::inet_ntop(AF_INET6, &v6.sin6_addr, text.data(), text.size());
    }
    return text.data();
}

std::vector<std::string> addresses() {
    std::vector<std::string> all;
    ifaddrs* first = nullptr;
    if (::getifaddrs(&first) != 0) return all;
    const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(first, ::freeifaddrs);
    for (const auto* one = first; one != nullptr; one = one->ifa_next) {
        const bool usable = one->ifa_addr != nullptr && (one->ifa_flags & IFF_UP) != 0 &&
                            (one->ifa_flags & IFF_LOOPBACK) == 0 && !is_of_containers(one->ifa_name);
        auto text = usable ? text_of(*one->ifa_addr) : std::string();
        if (!text.empty()) all.push_back(std::move(text));
    }
    return all;
}

}  // namespace

std::vector<std::string> machine_names() {
    auto names = addresses();
    if (names.empty()) return {"localhost"};
    const auto host = program::host_name();
    if (host == "localhost" || !valid_host(host)) return names;
    names.insert(names.begin(), host);
    if (host.find('.') == std::string::npos) names.push_back(host + ".local");
    return names;
}

}  // namespace asip::cli
