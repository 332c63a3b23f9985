// SPDX-License-Identifier: Apache-2.0
#include "sim/program/pty.hpp"

#include <fcntl.h>
#include <pty.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "sim/program/tty_speed.hpp"

namespace asip::sim {

Expected<Pty> Pty::open() {
    int master = -1;
    int slave = -1;
    char path[128];
    termios settings{};
    cfmakeraw(&settings);
    settings.c_cflag |= CREAD | CLOCAL;
    cfsetspeed(&settings, B57600);
    if (openpty(&master, &slave, path, &settings, nullptr) != 0)
        return fail(std::string("cannot open a pseudo-terminal: ") + std::strerror(errno));
    fcntl(master, F_SETFL, fcntl(master, F_GETFL) | O_NONBLOCK);
    fcntl(master, F_SETFD, FD_CLOEXEC);
    ::close(slave);
    Pty pty;
    pty.master_ = Descriptor(master);
    pty.path_ = path;
    pty.watch_ = Descriptor(inotify_init1(IN_NONBLOCK | IN_CLOEXEC));
    if (pty.watch_.valid()) inotify_add_watch(pty.watch_.number(), path, IN_OPEN);
    return pty;
}

Pty::Events Pty::look() {
    pollfd polled[] = {{watch_.number(), POLLIN, 0}, {master_.number(), POLLIN, 0}};
    if (::poll(polled, 2, 0) < 0) return {.in_use = was_in_use_};
    Events events{.in_use = (polled[1].revents & POLLHUP) == 0,
                  .readable = (polled[1].revents & POLLIN) != 0};
    char opened[1024];
    events.opened = !watch_.valid() ? events.in_use && !was_in_use_
                                    : (polled[0].revents & POLLIN) != 0 &&
                                          ::read(watch_.number(), opened, sizeof opened) > 0;
    was_in_use_ = events.in_use;
    return events;
}

void Pty::add_waits(std::vector<pollfd>& waits, bool with_bytes) const {
    waits.push_back({watch_.number(), POLLIN, 0});
    // One that no program has open is always ready.
    if (was_in_use_ && with_bytes) waits.push_back({master_.number(), POLLIN, 0});
}

std::uint32_t Pty::baud() const {
    return tty_speed(master_.number());
}

std::string Pty::read(std::size_t max_bytes) {
    std::string bytes(max_bytes, '\0');
    const auto count = ::read(master_.number(), bytes.data(), bytes.size());
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
}

std::size_t Pty::write(std::string_view bytes) {
    const auto count = ::write(master_.number(), bytes.data(), bytes.size());
    return count > 0 ? static_cast<std::size_t>(count) : 0;
}

namespace {

constexpr std::string_view kTerminals = "/dev/pts/";

bool earlier(const timespec& one, const timespec& other) {
    return one.tv_sec != other.tv_sec ? one.tv_sec < other.tv_sec : one.tv_nsec < other.tv_nsec;
}

/// Whether the link was left by a program that has ended. Its maker opens the port first: where the port is
/// newer than the link, its number has been given to another program since.
bool is_left_over(const std::filesystem::path& link, const std::string& target) {
    std::error_code error;
    const auto to = std::filesystem::read_symlink(link, error).string();
    if (to == target) return true;
    struct stat port{};
    struct stat made{};
    if (error || !to.starts_with(kTerminals) || ::lstat(link.c_str(), &made) != 0) return false;
    if (::stat(to.c_str(), &port) != 0) return errno == ENOENT;
    return S_ISCHR(port.st_mode) && earlier(made.st_mtim, port.st_ctim);
}

}  // namespace

Expected<PortLink> PortLink::create(const std::filesystem::path& link, const std::string& target) {
    std::error_code error;
    if (std::filesystem::exists(std::filesystem::symlink_status(link, error))) {
        if (!is_left_over(link, target))
            return fail(link.string() + ": exists already; remove it or choose another link");
        std::filesystem::remove(link, error);
    }
    std::filesystem::create_symlink(target, link, error);
    if (error) return fail(link.string() + ": cannot make the link: " + error.message());
    PortLink result;
    result.link_ = link;
    result.target_ = target;
    return result;
}

PortLink::~PortLink() {
    std::error_code error;
    if (!link_.empty() && std::filesystem::read_symlink(link_, error) == target_)
        std::filesystem::remove(link_, error);
}

PortLink::PortLink(PortLink&& other) noexcept
    : link_(std::exchange(other.link_, {})), target_(std::move(other.target_)) {}

PortLink& PortLink::operator=(PortLink&& other) noexcept {
    std::swap(link_, other.link_);
    std::swap(target_, other.target_);
    return *this;
}

}  // namespace asip::sim
