// SPDX-License-Identifier: Apache-2.0
#include "tests/support/terminal.hpp"

#include <pty.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <regex>
#include <stdexcept>
#include <thread>

#include "tests/support/child_process.hpp"

namespace asip::test {
namespace {

constexpr unsigned short kRows = 24;
constexpr unsigned short kColumns = 80;

std::vector<char*> as_pointers(std::vector<std::string>& texts) {
    std::vector<char*> list;
    for (auto& text : texts)
        list.push_back(text.data());
    list.push_back(nullptr);
    return list;
}

}  // namespace

struct TerminalProcess::State {
    pid_t pid = -1;
    int terminal = -1;
    std::optional<int> status;
    mutable std::mutex mutex;
    std::string written;
    std::atomic<bool> stop = false;
    std::thread reader;

    void read_output() {
        char buffer[4096];
        for (ssize_t size = 0; !stop;) {
            size = read(terminal, buffer, sizeof buffer);
            if (size < 0 && errno == EINTR) continue;
            // EIO: no process has the other end open any more.
            if (size <= 0) return;
            const std::lock_guard lock(mutex);
            written.append(buffer, static_cast<std::size_t>(size));
        }
    }
    void reap(int flags) {
        int result = 0;
        if (status || waitpid(pid, &result, flags) != pid) return;
        status = WIFSIGNALED(result) ? 128 + WTERMSIG(result) : WEXITSTATUS(result);
    }
};

TerminalProcess::TerminalProcess(std::vector<std::string> arguments,
                                 std::map<std::string, std::string> environment)
    : state_(std::make_unique<State>()) {
    arguments[0] = program_to_start(arguments[0]);
    environment.try_emplace("TERM", "xterm");
    auto variables = child_environment(environment);
    const auto words = as_pointers(arguments);
    const auto values = as_pointers(variables);
    winsize size{kRows, kColumns, 0, 0};
    state_->pid = forkpty(&state_->terminal, nullptr, nullptr, &size);
    if (state_->pid < 0) throw std::runtime_error("forkpty failed");
    if (state_->pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        execve(words[0], words.data(), values.data());
        _exit(127);
    }
    state_->reader = std::thread([state = state_.get()] { state->read_output(); });
}

TerminalProcess::~TerminalProcess() {
    state_->reap(WNOHANG);
    if (!state_->status) {
        // It leads a session of its own, with all that it started.
        kill(-state_->pid, SIGKILL);
        state_->reap(0);
    }
    state_->stop = true;
    state_->reader.join();
    close(state_->terminal);
}

void TerminalProcess::type(const std::string& keys) {
    for (std::size_t sent = 0; sent < keys.size();) {
        const auto size = write(state_->terminal, keys.data() + sent, keys.size() - sent);
        if (size < 0 && errno != EINTR) throw std::runtime_error("the terminal takes nothing");
        sent += static_cast<std::size_t>(std::max<ssize_t>(size, 0));
    }
}

std::string TerminalProcess::written() const {
    static const std::regex kEscapes(
        "\x1b(\\[[0-?]*[ -/]*[@-~]|\\][^\x07\x1b]*(\x07|\x1b\\\\)|[()].|[^\\[\\]()])");
    const std::lock_guard lock(state_->mutex);
    return std::regex_replace(state_->written, kEscapes, "");
}

bool TerminalProcess::shows(const std::string& pattern, std::chrono::milliseconds limit) const {
    const std::regex wanted(pattern, std::regex::ECMAScript | std::regex::multiline);
    return wait_until([&] { return std::regex_search(written(), wanted); }, limit);
}

std::optional<int> TerminalProcess::wait_exit(std::chrono::milliseconds limit) {
    wait_until(
        [this] {
            state_->reap(WNOHANG);
            return state_->status.has_value();
        },
        limit);
    return state_->status;
}

}  // namespace asip::test
