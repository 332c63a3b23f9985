// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

#include "sim/program/pico_board.hpp"

extern char** environ;

namespace asip::sim {
namespace {

constexpr auto kStart = std::chrono::seconds(30);
constexpr int kLineInChild = 3;
constexpr std::size_t kMaxLine = std::size_t{64} * 1024;

/// Beside the program, in its build folder as where it is installed.
std::filesystem::path script() {
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    return program.parent_path().parent_path() / "share/asip-sim/pico/main.mjs";
}

struct Pair {
    int ours = -1, theirs = -1;
};

Pair make_pipe(bool ours_reads) {
    std::array<int, 2> ends{-1, -1};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {};
    return ours_reads ? Pair{ends[0], ends[1]} : Pair{ends[1], ends[0]};
}

Pair make_socket() {
    std::array<int, 2> ends{-1, -1};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return {};
    ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
    return {ends[0], ends[1]};
}

void close_if_open(int& fd) {
    if (fd >= 0) ::close(fd);
    fd = -1;
}

}  // namespace

Expected<PicoProcess> PicoProcess::start(const nlohmann::json& board) {
    const auto path = script().string();
    if (::access(path.c_str(), R_OK) != 0)
        return fail(fmt::format("a Pico is run by {}, which is not there", path));
    auto settings = board;
    settings["line"] = kLineInChild;
    auto text = settings.dump();

    PicoProcess process;
    auto line = make_socket();
    auto input = make_pipe(false), output = make_pipe(true), error = make_pipe(true);
    process.line_ = line.ours;
    process.input_ = input.ours;
    process.output_ = output.ours;
    process.error_ = error.ours;
    int problem = errno;
    if (line.theirs >= 0 && input.theirs >= 0 && output.theirs >= 0 && error.theirs >= 0) {
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        // The line last: the others must not be on its number while they are copied.
        posix_spawn_file_actions_adddup2(&actions, input.theirs, STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&actions, output.theirs, STDOUT_FILENO);
        posix_spawn_file_actions_adddup2(&actions, error.theirs, STDERR_FILENO);
        posix_spawn_file_actions_adddup2(&actions, line.theirs, kLineInChild);
        posix_spawnattr_t attributes;
        posix_spawnattr_init(&attributes);
        // Ctrl-C is for asip-sim, which ends it; and the signals that this process blocks are its own.
        sigset_t none;
        sigemptyset(&none);
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setpgroup(&attributes, 0);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
        std::string node = "node", script = path;
        std::array<char*, 4> words{node.data(), script.data(), text.data(), nullptr};
        problem = posix_spawnp(&process.pid_, "node", &actions, &attributes, words.data(), environ);
        posix_spawnattr_destroy(&attributes);
        posix_spawn_file_actions_destroy(&actions);
    }
    for (auto* pair : {&line, &input, &output, &error})
        close_if_open(pair->theirs);
    if (problem == ENOENT)
        return fail(
            std::string("a Pico needs Node.js and its emulator: apt install nodejs npm, then npm install "
                        "--global rp2040js@1.4.1"));
    if (process.pid_ <= 0) return fail(fmt::format("cannot start node: {}", std::strerror(problem)));
    if (!process.read(kStart))
        return fail(process.is_running() ? std::string("the emulator of the Pico does not start")
                                         : process.errors());
    return process;
}

PicoProcess& PicoProcess::operator=(PicoProcess&& other) noexcept {
    end();
    pid_ = std::exchange(other.pid_, -1);
    line_ = std::exchange(other.line_, -1);
    input_ = std::exchange(other.input_, -1);
    output_ = std::exchange(other.output_, -1);
    error_ = std::exchange(other.error_, -1);
    received_ = std::move(other.received_);
    return *this;
}

PicoProcess::~PicoProcess() {
    end();
}

void PicoProcess::end() {
    for (auto* fd : {&line_, &input_, &output_, &error_})
        close_if_open(*fd);
    if (pid_ <= 0) return;
    ::kill(pid_, SIGTERM);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
}

std::string PicoProcess::errors() {
    // A process that has ended has written all of it; one that has not may never write.
    pollfd wait{error_, POLLIN, 0};
    std::array<char, 1024> buffer{};
    const auto count = ::poll(&wait, 1, 1000) > 0 ? ::read(error_, buffer.data(), buffer.size()) : 0;
    std::string text(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    text.resize(std::min(text.size(), text.find('\n')));
    return text.empty() ? std::string("the emulator of the Pico has ended") : text;
}

void PicoProcess::write(const nlohmann::json& command) {
    const auto text = command.dump() + "\n";
    std::size_t done = 0;
    while (input_ >= 0 && done < text.size()) {
        const auto count = ::write(input_, text.data() + done, text.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return close_if_open(input_);
        done += static_cast<std::size_t>(count);
    }
}

std::optional<nlohmann::json> PicoProcess::read(std::chrono::milliseconds limit) {
    const auto end = Clock::now() + limit;
    for (;;) {
        if (const auto length = received_.find('\n'); length != std::string::npos) {
            auto object = nlohmann::json::parse(
                received_.begin(), received_.begin() + static_cast<long>(length), nullptr, false);
            received_.erase(0, length + 1);
            if (object.is_object()) return object;
            continue;
        }
        if (output_ < 0 || received_.size() > kMaxLine) return std::nullopt;
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
        pollfd wait{output_, POLLIN, 0};
        if (::poll(&wait, 1, static_cast<int>(std::max<long>(left, 0))) <= 0) return std::nullopt;
        std::array<char, 4096> buffer{};
        const auto count = ::read(output_, buffer.data(), buffer.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) {
            close_if_open(output_);
            return std::nullopt;
        }
        received_.append(buffer.data(), static_cast<std::size_t>(count));
    }
}

}  // namespace asip::sim
