// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/network.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <random>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "tests/support/child_process.hpp"

namespace cluster {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::size_t kLargestPacket = 2048;
constexpr std::size_t kLongestQueue = 20'000;
constexpr std::uint32_t kFirstAddress = 0x0A4D0001;  // 10.77.0.1

int checked(int result, const char* what) {
    if (result < 0) throw std::system_error(errno, std::generic_category(), what);
    return result;
}

class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&&) = delete;
    int number() const { return number_; }

  private:
    int number_;
};

ifreq request_for(const char* interface) {
    ifreq request{};
    std::strncpy(request.ifr_name, interface, sizeof request.ifr_name - 1);
    return request;
}

void bring_up(int socket, const char* interface) {
    auto request = request_for(interface);
    request.ifr_flags = IFF_UP | IFF_RUNNING;
    checked(ioctl(socket, SIOCSIFFLAGS, &request), "SIOCSIFFLAGS");
}

void set_address(int socket, const char* interface, unsigned long what, std::uint32_t address) {
    auto request = request_for(interface);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(address);
    std::memcpy(&request.ifr_addr, &to, sizeof to);
    checked(ioctl(socket, what, &request), "address of an interface");
}

/// The interface of the calling thread's namespace.
Descriptor make_interface(const std::vector<std::uint32_t>& addresses) {
    Descriptor tun(checked(::open("/dev/net/tun", O_RDWR | O_CLOEXEC | O_NONBLOCK), "/dev/net/tun"));
    auto request = request_for("bus0");
    request.ifr_flags = IFF_TUN | IFF_NO_PI;
    checked(ioctl(tun.number(), TUNSETIFF, &request), "TUNSETIFF");
    const Descriptor socket(checked(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0), "socket"));
    bring_up(socket.number(), "lo");
    for (std::size_t i = 0; i < addresses.size(); ++i) {
        const auto name = i == 0 ? std::string("bus0") : fmt::format("bus0:{}", i);
        set_address(socket.number(), name.c_str(), SIOCSIFADDR, addresses[i]);
        set_address(socket.number(), name.c_str(), SIOCSIFNETMASK, 0xFFFFFF00);
    }
    bring_up(socket.number(), "bus0");
    // TCP sends again at least that often, so that connections go on a second after a cut and not as long
    // after it as it lasted. Linux 6.15 and later; elsewhere there is no such file. And for four minutes: by
    // itself TCP counts how often it sent again, and would give a connection up after 15 s now.
    if (std::ofstream file("/proc/sys/net/ipv4/tcp_rto_max_ms"); file << 1000 << std::flush)
        std::ofstream("/proc/sys/net/ipv4/tcp_retries2") << 255;
    return tun;
}

std::size_t host_at(std::string_view packet, std::size_t offset) {
    std::uint32_t address = 0;
    std::memcpy(&address, packet.data() + offset, sizeof address);
    return ntohl(address) - kFirstAddress;
}

}  // namespace

struct Network::State {
    struct Host {
        Descriptor tun;
        Descriptor space;
        Weather weather{};
        SteadyClock::time_point since{};
        std::size_t group = 0;  // none
    };

    const Host* port(std::size_t host) const {
        if (host == kHere || host == kWired) return hosts.data();
        return host < hosts.size() + 1 ? &hosts[host - 1] : nullptr;
    }
    Host& weather_of(std::size_t host) { return hosts.at(host < kFirst ? 0 : host - 1); }

    bool dice(double probability) {
        return probability > 0 && std::uniform_real_distribution<>()(random) < probability;
    }

    static bool flapped(const Host& host, SteadyClock::time_point now) {
        const auto period = host.weather.flapping;
        return period.count() > 0 && (now - host.since) / period % 2 == 0;
    }

    void take(std::string_view packet) {
        constexpr std::size_t kHeader = 20, kSource = 12, kDestination = 16;
        if (packet.size() < kHeader || (static_cast<unsigned char>(packet[0]) >> 4) != 4) return;
        const auto from = host_at(packet, kSource), to = host_at(packet, kDestination);
        const Host *const sender = port(from), *const receiver = port(to);
        if (sender == nullptr || receiver == nullptr) return;
        std::chrono::milliseconds delay{0};
        const bool together = sender->group != 0 && sender->group == receiver->group;
        if (from != kWired && to != kWired && !together) {
            const auto now = SteadyClock::now();
            const auto &out = sender->weather, &in = receiver->weather;
            if (out.drops_out || in.drops_in || flapped(*sender, now) || flapped(*receiver, now)) return;
            if (dice(out.loss) || dice(in.loss)) return;
            delay = out.delay;
        }
        if (delay.count() == 0) return deliver(*receiver, packet);
        if (waiting.size() < kLongestQueue)
            waiting.emplace(SteadyClock::now() + delay, Waiting{receiver, std::string(packet)});
    }

    static void deliver(const Host& to, std::string_view packet) {
        // Like a router with a full queue, an interface that cannot take it loses it.
        [[maybe_unused]] const auto written = ::write(to.tun.number(), packet.data(), packet.size());
    }

    void deliver_due() {
        while (!waiting.empty() && waiting.begin()->first <= SteadyClock::now()) {
            deliver(*waiting.begin()->second.to, waiting.begin()->second.packet);
            waiting.erase(waiting.begin());
        }
    }

    void run() {
        std::vector<pollfd> watched;
        for (const auto& host : hosts)
            watched.push_back({host.tun.number(), POLLIN, 0});
        watched.push_back({end.number(), POLLIN, 0});
        std::array<char, kLargestPacket> buffer{};
        while (watched.back().revents == 0) {
            timespec patience{.tv_sec = 0, .tv_nsec = waiting.empty() ? 500'000'000 : 1'000'000};
            ppoll(watched.data(), watched.size(), &patience, nullptr);
            const std::lock_guard lock(mutex);
            deliver_due();
            for (std::size_t i = 0; i < hosts.size(); ++i) {
                if (watched[i].revents == 0) continue;
                for (int turn = 0; turn < 64; ++turn) {
                    const auto count = ::read(watched[i].fd, buffer.data(), buffer.size());
                    if (count <= 0) break;
                    take({buffer.data(), static_cast<std::size_t>(count)});
                }
            }
        }
    }

    struct Waiting {
        const Host* to;
        std::string packet;
    };

    std::vector<Host> hosts;  // this process under both of its addresses, then the others
    Descriptor end{checked(::eventfd(0, EFD_CLOEXEC), "eventfd")};
    std::mutex mutex;  // of what is below, and of the weather
    std::multimap<SteadyClock::time_point, Waiting> waiting;
    std::mt19937_64 random{1};
    std::size_t groups = 0;
    std::thread thread;
};

std::string Network::impossible() {
    if (geteuid() != 0) return "hosts with a network of their own can only be made by root";
    if (::access("/dev/net/tun", R_OK | W_OK) != 0) return "there is no /dev/net/tun";
    if (asip::test::run({"unshare", "--net", "nsenter", "--version"}).status != 0)
        return "no network namespace can be made here";
    return {};
}

Network::Network(std::size_t hosts) : state_(std::make_unique<State>()) {
    checked(unshare(CLONE_NEWNET), "unshare");
    auto& made = state_->hosts;
    const auto open_space = [] {
        return Descriptor(checked(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC), "namespace"));
    };
    made.push_back({make_interface({kFirstAddress, kFirstAddress + kWired}), open_space()});
    std::exception_ptr failure;
    for (std::size_t host = kFirst; host < hosts; ++host)
        std::thread([&] {
            try {
                checked(unshare(CLONE_NEWNET), "unshare");
                auto tun = make_interface({kFirstAddress + static_cast<std::uint32_t>(host)});
                made.push_back({std::move(tun), open_space()});
            } catch (...) {
                failure = std::current_exception();
            }
        }).join();
    if (failure) std::rethrow_exception(failure);
    state_->thread = std::thread([state = state_.get()] { state->run(); });
}

Network::~Network() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(state_->end.number(), &one, sizeof one);
    state_->thread.join();
}

std::string Network::address(std::size_t host) {
    return fmt::format("10.77.0.{}", host + 1);
}

std::vector<std::string> Network::inside(std::size_t host, std::vector<std::string> command) const {
    if (host < kFirst) return command;
    command[0] = asip::test::program_to_start(command[0]);
    const int space = state_->hosts.at(host - 1).space.number();
    std::vector<std::string> whole{"nsenter", fmt::format("--net=/proc/{}/fd/{}", getpid(), space), "--"};
    whole.insert(whole.end(), command.begin(), command.end());
    return whole;
}

void Network::set(const std::vector<std::size_t>& group, const Weather& weather) {
    const std::lock_guard lock(state_->mutex);
    const auto number = ++state_->groups;
    for (const auto host : group) {
        auto& changed = state_->weather_of(host);
        changed.weather = weather;
        changed.since = SteadyClock::now();
        changed.group = number;
    }
}

void Network::clear(const std::vector<std::size_t>& group) {
    const std::lock_guard lock(state_->mutex);
    for (const auto host : group) {
        auto& changed = state_->weather_of(host);
        changed.weather = {};
        changed.group = 0;
    }
}

}  // namespace cluster
