// SPDX-License-Identifier: Apache-2.0
#include "asip/program/service_manager.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

#include "asip/descriptor.hpp"

namespace asip::program {
namespace {

constexpr const char* kVariable = "NOTIFY_SOCKET";

}  // namespace

bool has_service_manager() {
    const char* path = std::getenv(kVariable);
    return path != nullptr && (*path == '/' || *path == '@');
}

bool supervised() {
    if (has_service_manager() || getpid() == 1) return true;
    const char* process = std::getenv("SYSTEMD_EXEC_PID");
    if (process != nullptr && std::to_string(getpid()) == process) return true;
    return std::getenv("INVOCATION_ID") != nullptr && isatty(STDERR_FILENO) == 0;
}

void tell_service_manager(std::string_view lines) {
    if (!has_service_manager()) return;
    const std::string_view path = std::getenv(kVariable);
    sockaddr_un address{};
    if (path.size() >= sizeof address.sun_path) return;
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    if (path.front() == '@') address.sun_path[0] = '\0';
    const Descriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
    sendto(socket.number(), lines.data(), lines.size(), MSG_NOSIGNAL,
           reinterpret_cast<const sockaddr*>(&address), length);
}

}  // namespace asip::program
