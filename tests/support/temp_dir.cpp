// SPDX-License-Identifier: Apache-2.0
#include "tests/support/temp_dir.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>
#include <random>
#include <stdexcept>

namespace asip::test {

TempDir::TempDir() {
    std::string pattern = (std::filesystem::temp_directory_path() / "asip-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot create " + pattern);
    path_ = pattern;
}

TempDir::~TempDir() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::string TempDir::write(std::string_view name, std::string_view content) const {
    const auto path = file(name);
    std::ofstream stream(path, std::ios::binary);
    stream << content;
    if (!stream.flush()) throw std::runtime_error("cannot write " + path);
    return path;
}

std::string settings_file(std::string_view text) {
    static const TempDir folder;
    static int number = 0;
    return folder.write(std::to_string(++number) + ".conf", text);
}

namespace {

constexpr int kFirstPort = 10'000;

bool can_bind(int port) {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool bound = fd >= 0 && bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    if (fd >= 0) close(fd);
    return bound;
}

/// The first of those that the kernel gives to connections by itself.
int first_ephemeral_port() {
    int first = 0;
    std::ifstream("/proc/sys/net/ipv4/ip_local_port_range") >> first;
    return first > 2 * kFirstPort ? first : 32'768;
}

}  // namespace

std::uint16_t free_port() {
    thread_local std::mt19937 random(std::random_device{}());
    std::uniform_int_distribution<int> ports(kFirstPort, first_ephemeral_port() - 1);
    for (int attempt = 0; attempt < 1000; ++attempt)
        if (const int port = ports(random); can_bind(port)) return static_cast<std::uint16_t>(port);
    throw std::runtime_error("no free port on 127.0.0.1");
}

bool accepts(std::uint16_t port) {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool connected = connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    close(fd);
    return connected;
}

}  // namespace asip::test
