// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/live/line_proxy.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace truth {

std::int64_t now_ms() {
    using namespace std::chrono;
    return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
}

LineProxy::LineProxy(std::string path, std::uint16_t board_port, std::uint64_t seed)
    : path_(std::move(path)), board_port_(board_port), dice_(seed) {
    open_terminal();
    thread_ = std::thread([this] { run(); });
}

LineProxy::~LineProxy() {
    stop_ = true;
    thread_.join();
    unplug();
}

void LineProxy::open_terminal() {
    int slave = -1;
    char name[128];
    termios raw{};
    cfmakeraw(&raw);
    if (openpty(&terminal_, &slave, name, &raw, nullptr) != 0) return;
    fcntl(terminal_, F_SETFL, O_NONBLOCK);
    close(slave);
    unlink(path_.c_str());
    if (symlink(name, path_.c_str()) != 0) return;
}

void LineProxy::connect_board() {
    board_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(board_port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(board_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
        close(std::exchange(board_, -1));
    else
        fcntl(board_, F_SETFL, O_NONBLOCK);
}

void LineProxy::unplug() {
    const std::lock_guard lock(mutex_);
    unlink(path_.c_str());
    if (terminal_ >= 0) close(std::exchange(terminal_, -1));
    if (board_ >= 0) close(std::exchange(board_, -1));
    held_ = {};
    partial_.clear();
    faults_.push_back(now_ms());
}

void LineProxy::plug() {
    const std::lock_guard lock(mutex_);
    open_terminal();
}

void LineProxy::run() {
    while (!stop_) {
        {
            const std::lock_guard lock(mutex_);
            if (terminal_ >= 0 && board_ < 0) connect_board();
            if (terminal_ >= 0 && board_ >= 0) {
                pass(terminal_, board_, 0);
                pass(board_, terminal_, 1);
            }
        }
        pollfd none{-1, 0, 0};
        poll(&none, 1, 1);
    }
}

void LineProxy::pass(int from, int to, std::size_t direction) {
    char buffer[512];
    const auto count = read(from, buffer, sizeof buffer);
    if (count > 0 && direction == 0) note_requests(buffer, static_cast<std::size_t>(count));
    if (count > 0) held_[direction] += spoil(buffer, static_cast<std::size_t>(count));
    if (count == 0 && from == board_) close(std::exchange(board_, -1));
    if (stalled_ || held_[direction].empty() || board_ < 0) return;
    const auto written = write(to, held_[direction].data(), held_[direction].size());
    if (written > 0) held_[direction].erase(0, static_cast<std::size_t>(written));
}

std::uint64_t LineProxy::faults() {
    const std::lock_guard lock(mutex_);
    return faults_.size();
}

bool LineProxy::damaged(std::int64_t from, std::int64_t until) {
    const std::lock_guard lock(mutex_);
    return std::any_of(faults_.begin(), faults_.end(),
                       [&](std::int64_t fault) { return fault >= from && fault <= until; });
}

void LineProxy::note_requests(const char* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        if (bytes[i] != '\n') {
            partial_ += bytes[i];
            continue;
        }
        auto& seen = seen_[partial_.substr(0, partial_.find('*'))];
        ++seen.times;
        seen.last_ms = now_ms();
        partial_.clear();
    }
}

LineProxy::Seen LineProxy::seen(const std::string& request) {
    const std::lock_guard lock(mutex_);
    const auto known = seen_.find(request);
    return known == seen_.end() ? Seen{} : known->second;
}

std::string LineProxy::spoil(const char* bytes, std::size_t count) {
    std::string passed;
    const double chance = per_byte_;
    for (std::size_t i = 0; i < count; ++i) {
        if (!dice_.chance(chance)) {
            passed += bytes[i];
            continue;
        }
        faults_.push_back(now_ms());
        switch (dice_.below(3)) {
            case 0:  // lost
                break;
            case 1:  // twice
                passed += bytes[i];
                passed += bytes[i];
                break;
            default:
                passed += static_cast<char>(bytes[i] ^ (1 << dice_.below(7)));
        }
    }
    return passed;
}

}  // namespace truth
