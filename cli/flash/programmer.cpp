// SPDX-License-Identifier: Apache-2.0
#include "cli/flash/programmer.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "asip/link/boot_loader.hpp"

extern char** environ;

namespace asip::cli {
namespace {

/// `i` for Intel .hex, `e` for .elf, by the first byte; 0 for anything else.
char image_format(const std::string& file) {
    const int first = std::ifstream(file, std::ios::binary).get();
    return first == ':' ? 'i' : first == 0x7f ? 'e' : '\0';
}

}  // namespace

Expected<std::vector<std::string>> avrdude_call(const Programming& what) {
    const char format = image_format(what.image);
    if (format == '\0') return fail(what.image + " cannot be read, or is neither a .hex nor an .elf file");
    const auto known = link::boot_loader_of_chip(what.chip).value_or(link::BootLoader{});
    const std::string baud = what.baud == 0 ? std::string(known.baud) : std::to_string(what.baud);
    link::BootLoader loader = known;
    if (!what.part.empty()) loader.part = what.part;
    if (!what.method.empty()) loader.method = what.method;
    loader.baud = baud;
    if (loader.part.empty() || loader.method.empty() || loader.baud.empty())
        return fail(
            "no boot loader is known for the chip \"" + what.chip +
            "\"; give --part, --programmer and --baud, or use asipctl release and a tool of your own");
    auto call = link::avrdude_call(loader, what.avrdude, what.path, what.image, format);
    call.insert(call.begin() + 1, "-q");
    return call;
}

std::vector<std::string> simulator_call(const std::string& board, const std::string& image,
                                        const std::string& socket) {
    // Beside this program where it is there, as in a build folder; else in PATH.
    std::error_code error;
    const auto here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "asip-sim";
    std::vector<std::string> call{std::filesystem::exists(here, error) ? here.string() : "asip-sim", "ctl"};
    if (!socket.empty()) call.insert(call.end(), {"--socket", socket});
    call.insert(call.end(), {"load", board, std::filesystem::absolute(image, error).string()});
    return call;
}

bool is_simulated_port(const std::string& path) {
    std::error_code error;
    return std::filesystem::canonical(path, error).string().starts_with("/dev/pts/");
}

Expected<void> check_port(const std::string& path) {
    std::error_code error;
    const auto device = std::filesystem::canonical(path, error);
    const auto known = "/sys/class/tty/" + device.filename().string() + "/device";
    if (is_simulated_port(path) || (device.parent_path() == "/dev" && std::filesystem::exists(known, error)))
        return {};
    return fail(path + " is no serial port of this machine");
}

Expected<RunningProgram> RunningProgram::start(const std::vector<std::string>& call) {
    std::vector<char*> arguments;
    for (const auto& word : call)
        arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
    pid_t pid = 0;
    const int problem = posix_spawnp(&pid, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (problem != 0) return fail(call.front() + " cannot be started: " + std::strerror(problem));
    return RunningProgram(pid);
}

namespace {

int exit_status(int status) {
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::optional<int> RunningProgram::ended() {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
    return exit_status(status);
}

void RunningProgram::stop(bool by_force) {
    ::kill(pid_, by_force ? SIGKILL : SIGTERM);
}

int RunningProgram::wait() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0)
        if (errno != EINTR) return -1;
    return exit_status(status);
}

namespace {

constexpr Duration kBetweenAttempts = std::chrono::milliseconds(100);

/// None: see errno.
Descriptor open_and_lock(const std::string& path) {
    // Not closed on exec: the programmer keeps the lock when this program is killed.
    Descriptor port(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    if (!port.valid() || ::flock(port.number(), LOCK_EX | LOCK_NB) == 0) return port;
    port = Descriptor();
    errno = EBUSY;
    return port;
}

}  // namespace

Expected<PortLock> PortLock::take(const std::string& path, const std::function<void(Duration)>& pause) {
    auto port = open_and_lock(path);
    for (Duration waited{}; !port.valid() && errno == EBUSY && waited < kPatience;
         waited += kBetweenAttempts) {
        pause(kBetweenAttempts);
        port = open_and_lock(path);
    }
    if (port.valid()) return PortLock(std::move(port));
    if (errno == EBUSY) return fail(path + " is in use by another program (fuser " + path + ")");
    return fail(path + " cannot be opened: " + std::strerror(errno));
}

}  // namespace asip::cli
