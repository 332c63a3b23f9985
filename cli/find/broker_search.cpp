// SPDX-License-Identifier: Apache-2.0
#include "cli/find/broker_search.hpp"

#include <arpa/inet.h>
#include <arpa/nameser.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <resolv.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>

#include "asip/descriptor.hpp"
#include "asip/random.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

constexpr const char* kService = "_mqtt._tcp.local";
constexpr const char* kGroup = "224.0.0.251";
constexpr std::uint16_t kPort = 5353;
/// Responders spread their answers over 120 ms.
constexpr Duration kAfterFirst = 300ms;
constexpr std::size_t kMaxBrokers = 32;
constexpr std::size_t kSrvFixed = 6;  // priority, weight, port

Descriptor open_socket(int type) {
    return Descriptor(socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

sockaddr_in address_of(const char* host, std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    inet_pton(AF_INET, host, &address.sin_addr);
    return address;
}

std::string text_of(const in_addr& address) {
    char text[INET_ADDRSTRLEN] = "";
    inet_ntop(AF_INET, &address, text, sizeof text);
    return text;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// `Broker of the lab` of `Broker\032of\032the\032lab._mqtt._tcp.local`: names in text form escape what is
/// no letter.
std::string instance_name(const std::string& full) {
    std::string name;
    for (std::size_t i = 0; i < full.size() && full[i] != '.'; ++i) {
        if (full[i] != '\\' || i + 1 >= full.size()) {
            name += full[i];
        } else if (i + 3 < full.size() && std::isdigit(static_cast<unsigned char>(full[i + 1])) != 0) {
            name += static_cast<char>(std::atoi(full.substr(i + 1, 3).c_str()));
            i += 3;
        } else {
            name += full[++i];
        }
    }
    return name;
}

/// The records of an answer that tell of brokers.
struct Records {
    struct Server {
        std::string host;
        std::uint16_t port = 0;
    };
    std::vector<std::string> instances;
    std::map<std::string, Server> servers;
    std::map<std::string, std::string> addresses;
};

/// The name at `at`, which may refer to other parts of the packet.
std::optional<std::string> name_at(const ns_msg& message, const std::uint8_t* at) {
    char name[NS_MAXDNAME];
    if (dn_expand(ns_msg_base(message), ns_msg_end(message), at, name, sizeof name) < 0) return std::nullopt;
    return std::string(name);
}

void take_record(const ns_msg& message, const ns_rr& record, Records& records) {
    const std::string owner = lower(ns_rr_name(record));
    const std::size_t size = ns_rr_rdlen(record);
    const auto* data = ns_rr_rdata(record);
    if (ns_rr_type(record) == ns_t_ptr && owner == kService) {
        if (auto name = name_at(message, data)) records.instances.push_back(std::move(*name));
    } else if (ns_rr_type(record) == ns_t_srv && size > kSrvFixed) {
        if (const auto host = name_at(message, data + kSrvFixed))
            records.servers[owner] = {lower(*host), static_cast<std::uint16_t>(ns_get16(data + 4))};
    } else if (ns_rr_type(record) == ns_t_a && size == sizeof(in_addr)) {
        in_addr address{};
        std::copy_n(data, size, reinterpret_cast<std::uint8_t*>(&address));
        records.addresses[owner] = text_of(address);
    }
}

void add(std::vector<AnnouncedBroker>& all, const std::vector<AnnouncedBroker>& more) {
    for (const auto& broker : more) {
        const bool known = std::any_of(all.begin(), all.end(),
                                       [&](const auto& one) { return one.address == broker.address; });
        if (!known && all.size() < kMaxBrokers) all.push_back(broker);
    }
}

/// Addresses of this machine in networks that know multicast.
std::vector<in_addr> own_addresses() {
    std::vector<in_addr> result;
    ifaddrs* all = nullptr;
    if (getifaddrs(&all) != 0) return result;
    for (const auto* one = all; one != nullptr; one = one->ifa_next) {
        if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
        if ((one->ifa_flags & IFF_UP) == 0 || (one->ifa_flags & IFF_MULTICAST) == 0) continue;
        sockaddr_in address{};
        std::memcpy(&address, one->ifa_addr, sizeof address);
        result.push_back(address.sin_addr);
    }
    freeifaddrs(all);
    return result;
}

void ask_everywhere(int descriptor, const std::vector<std::uint8_t>& question) {
    const auto group = address_of(kGroup, kPort);
    const int hops = 255;
    setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_TTL, &hops, sizeof hops);
    for (const auto& own : own_addresses()) {
        setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_IF, &own, sizeof own);
        // A network that is down answers nothing.
        (void)sendto(descriptor, question.data(), question.size(), MSG_NOSIGNAL,
                     reinterpret_cast<const sockaddr*>(&group), sizeof group);
    }
}

std::vector<AnnouncedBroker> receive(int descriptor, std::uint16_t id) {
    std::array<std::uint8_t, 9000> packet{};
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const auto got =
        recvfrom(descriptor, packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (got <= 0 || ntohs(from.sin_port) != kPort) return {};
    return announced_brokers({packet.data(), static_cast<std::size_t>(got)}, id, text_of(from.sin_addr));
}

}  // namespace

std::vector<std::uint8_t> broker_question(std::uint16_t id) {
    const auto high = static_cast<std::uint8_t>(id >> 8U);
    const auto low = static_cast<std::uint8_t>(id & 0xffU);
    // One question: which name is a PTR of _mqtt._tcp.local in class IN?
    return {high, low, 0,   0,   0,   1,   0, 0,   0,   0,   0,   0,   5, '_', 'm', 'q', 't',
            't',  4,   '_', 't', 'c', 'p', 5, 'l', 'o', 'c', 'a', 'l', 0, 0,   12,  0,   1};
}

std::vector<AnnouncedBroker> announced_brokers(std::span<const std::uint8_t> packet, std::uint16_t id,
                                               const std::string& sender) {
    ns_msg message;
    if (ns_initparse(packet.data(), static_cast<int>(packet.size()), &message) != 0) return {};
    if (ns_msg_id(message) != id || ns_msg_getflag(message, ns_f_qr) == 0) return {};
    Records records;
    for (const auto section : {ns_s_an, ns_s_ar}) {
        ns_rr record;
        for (int i = 0; i < ns_msg_count(message, section); ++i) {
            if (ns_parserr(&message, section, i, &record) != 0) break;
            take_record(message, record, records);
        }
    }
    std::vector<AnnouncedBroker> result;
    for (const auto& instance : records.instances) {
        const auto server = records.servers.find(lower(instance));
        if (server == records.servers.end() || server->second.port == 0) continue;
        const auto address = records.addresses.find(server->second.host);
        const auto host = address == records.addresses.end() ? sender : address->second;
        add(result, {{instance_name(instance), {host, server->second.port, false}}});
    }
    return result;
}

std::vector<AnnouncedBroker> search_brokers(Duration patience) {
    const auto socket = open_socket(SOCK_DGRAM);
    if (socket.number() < 0) return {};
    const auto id = static_cast<std::uint16_t>(std::stoul(random_hex(system_random(), 4), nullptr, 16));
    ask_everywhere(socket.number(), broker_question(id));
    std::vector<AnnouncedBroker> result;
    for (auto end = Clock::now() + patience; Clock::now() < end;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
        pollfd input{socket.number(), POLLIN, 0};
        if (poll(&input, 1, static_cast<int>(left.count())) <= 0) continue;
        const bool first = result.empty();
        add(result, receive(socket.number(), id));
        if (first && !result.empty()) end = std::min(end, Clock::now() + kAfterFirst);
    }
    std::sort(result.begin(), result.end(),
              [](const auto& a, const auto& b) { return a.address.describe() < b.address.describe(); });
    return result;
}

bool listens_here(std::uint16_t port) {
    const auto here = address_of("127.0.0.1", port);
    const auto* address = reinterpret_cast<const sockaddr*>(&here);
    // Binding tells, without a connection that the broker would log.
    if (const auto socket = open_socket(SOCK_STREAM);
        bind(socket.number(), address, sizeof here) != 0 && errno == EADDRINUSE)
        return true;
    const auto socket = open_socket(SOCK_STREAM);
    if (connect(socket.number(), address, sizeof here) == 0) return true;
    if (errno != EINPROGRESS) return false;
    pollfd connecting{socket.number(), POLLOUT, 0};
    int error = 0;
    socklen_t size = sizeof error;
    return poll(&connecting, 1, 100) == 1 &&
           getsockopt(socket.number(), SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
}

}  // namespace asip::cli
