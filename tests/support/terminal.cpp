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

void Screen::write(const std::string& bytes) {
    for (const char c : bytes) {
        if (sequence_.empty() && c != '\033') {
            put(c);
            continue;
        }
        sequence_ += c;
        const bool begins = sequence_.size() == 2 && c == '[';
        const bool parameter = sequence_.size() > 2 && (c < '@' || c > '~');
        if (sequence_.size() == 1 || begins || parameter) continue;
        control(c);
        sequence_.clear();
    }
}

void Screen::put(char c) {
    if (c == '\r') {
        column_ = 0;
    } else if (c == '\n') {
        line_feed();
    } else if (c == '\b') {
        column_ = column_ == 0 ? 0 : std::min(column_, lines_[0].size()) - 1;
    } else if (static_cast<unsigned char>(c) >= 0x20) {
        // A terminal with automatic margins goes on only when the next character comes.
        if (column_ == lines_[0].size()) {
            column_ = 0;
            line_feed();
        }
        lines_[row_][column_++] = c;
    }
}

void Screen::line_feed() {
    if (row_ + 1 < lines_.size()) {
        ++row_;
        return;
    }
    lines_.erase(lines_.begin());
    lines_.emplace_back(lines_[0].size(), ' ');
}

void Screen::control(char final) {
    const auto number = static_cast<std::size_t>(std::max(0, std::atoi(sequence_.c_str() + 2)));
    const auto count = std::max<std::size_t>(number, 1);
    const auto columns = lines_[0].size();
    auto& line = lines_[row_];
    const auto at = std::min(column_, columns);
    if (final == 'A') row_ -= std::min(row_, count);
    if (final == 'B') row_ = std::min(row_ + count, lines_.size() - 1);
    if (final == 'C') column_ = std::min(column_ + count, columns - 1);
    if (final == 'D') column_ -= std::min(column_, count);
    if (final == 'G') column_ = std::min(count, columns) - 1;
    if (final == 'H') row_ = column_ = 0;
    if (final == '@')
        line = (line.substr(0, at) + std::string(count, ' ') + line.substr(at)).substr(0, columns);
    if (final == 'P') line = line.erase(at, count) + std::string(columns - line.size(), ' ');
    if (final == 'K' || final == 'J') line.replace(at, columns - at, columns - at, ' ');
    for (std::size_t row = number == 2 ? 0 : row_ + 1; final == 'J' && row < lines_.size(); ++row)
        lines_[row].assign(columns, ' ');
}

std::string Screen::line(std::size_t row) const {
    return lines_[row].substr(0, lines_[row].find_last_not_of(' ') + 1);
}

std::string Screen::text() const {
    std::string all;
    for (std::size_t row = 0; row < lines_.size(); ++row)
        all += line(row) + "\n";
    return all;
}

struct TerminalProcess::State {
    pid_t pid = -1;
    int terminal = -1;
    std::optional<int> status;
    mutable std::mutex mutex;
    Screen screen{kRows, kColumns};
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
            screen.write({buffer, static_cast<std::size_t>(size)});
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

pid_t TerminalProcess::pid() const {
    return state_->pid;
}

void TerminalProcess::type(const std::string& keys) {
    for (std::size_t sent = 0; sent < keys.size();) {
        const auto size = write(state_->terminal, keys.data() + sent, keys.size() - sent);
        if (size < 0 && errno != EINTR) throw std::runtime_error("the terminal takes nothing");
        sent += static_cast<std::size_t>(std::max<ssize_t>(size, 0));
    }
}

void TerminalProcess::resize(unsigned short rows, unsigned short columns) {
    winsize size{rows, columns, 0, 0};
    ioctl(state_->terminal, TIOCSWINSZ, &size);
}

Screen TerminalProcess::screen() const {
    const std::lock_guard lock(state_->mutex);
    return state_->screen;
}

bool TerminalProcess::shows(const std::string& pattern, std::chrono::milliseconds limit) const {
    const std::regex wanted(pattern);
    return wait_until(
        [&] {
            const auto now = screen();
            for (std::size_t row = 0; row < kRows; ++row)
                if (std::regex_search(now.line(row), wanted)) return true;
            return false;
        },
        limit);
}

bool TerminalProcess::edits(const std::string& line, std::chrono::milliseconds limit) const {
    return wait_until(
        [&] {
            const auto now = screen();
            return now.line(now.row()) == line;
        },
        limit);
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
