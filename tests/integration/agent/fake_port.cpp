// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/agent/fake_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

namespace asip::test {

FakePort::FakePort(bool answers) : answers_(answers) {
    char name[128];
    if (openpty(&master_, &slave_, name, nullptr, nullptr) != 0)
        throw std::runtime_error("no pseudo-terminal");
    path_ = name;
    termios settings{};
    tcgetattr(slave_, &settings);
    cfmakeraw(&settings);
    tcsetattr(slave_, TCSANOW, &settings);
    fcntl(master_, F_SETFL, O_NONBLOCK);
    board_.extensions = false;
    thread_ = std::thread([this] { serve(); });
}

FakePort::~FakePort() {
    stopping_ = true;
    thread_.join();
    close(master_);
    close(slave_);
}

void FakePort::say(std::string_view bytes) {
    while (!bytes.empty() && !stopping_) {
        const auto count = write(master_, bytes.data(), bytes.size());
        if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    }
}

void FakePort::flood(std::string line) {
    std::lock_guard lock(mutex_);
    flood_ = line.empty() ? line : line + "\r\n";
}

bool FakePort::executed(const std::string& line) {
    std::lock_guard lock(mutex_);
    return std::find(board_.executed.begin(), board_.executed.end(), line) != board_.executed.end();
}

std::vector<std::string> FakePort::heard() {
    std::lock_guard lock(mutex_);
    return board_.heard;
}

void FakePort::serve() {
    while (!stopping_) {
        pollfd poll_for{master_, POLLIN, 0};
        poll(&poll_for, 1, 5);
        char buffer[512];
        const auto count = read(master_, buffer, sizeof buffer);
        std::lock_guard lock(mutex_);
        if (count > 0 && answers_)
            say(board_.hear({buffer, static_cast<std::size_t>(count)}, 57600,
                            std::chrono::steady_clock::now()));
        for (int i = 0; i < 50 && !flood_.empty(); ++i)
            if (write(master_, flood_.data(), flood_.size()) < 0) break;
    }
}

}  // namespace asip::test
