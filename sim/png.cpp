// SPDX-License-Identifier: Apache-2.0
#include "sim/png.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>

extern char** environ;

namespace asip::sim {
namespace {

struct SpawnActions {
    SpawnActions() { posix_spawn_file_actions_init(&actions); }
    ~SpawnActions() { posix_spawn_file_actions_destroy(&actions); }
    SpawnActions(const SpawnActions&) = delete;
    SpawnActions& operator=(const SpawnActions&) = delete;
    posix_spawn_file_actions_t actions{};
};

/// Its exit status; nothing if it cannot be started, with errno.
std::optional<int> convert(int input, const std::string& file) {
    SpawnActions with;
    posix_spawn_file_actions_adddup2(&with.actions, input, STDIN_FILENO);
    posix_spawn_file_actions_addopen(&with.actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addclosefrom_np(&with.actions, STDERR_FILENO + 1);
    std::string words[] = {"rsvg-convert", "--format=png", "--keep-aspect-ratio",
                           "--width=" + std::to_string(kPngWidth), "--output=" + file};
    char* argv[] = {words[0].data(), words[1].data(), words[2].data(),
                    words[3].data(), words[4].data(), nullptr};
    pid_t pid = 0;
    if (const int problem = posix_spawnp(&pid, argv[0], &with.actions, nullptr, argv, environ);
        problem != 0) {
        errno = problem;
        return std::nullopt;
    }
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

Expected<void> save_as_png(const std::string& svg, const std::string& file) {
    const std::unique_ptr<FILE, int (*)(FILE*)> input(std::tmpfile(), std::fclose);
    if (!input || std::fwrite(svg.data(), 1, svg.size(), input.get()) != svg.size() ||
        std::fflush(input.get()) != 0 || lseek(fileno(input.get()), 0, SEEK_SET) != 0)
        return fail(file + ": there is no room for a temporary file");
    const auto status = convert(fileno(input.get()), file);
    if (!status && errno == ENOENT)
        return fail(
            file +
            ": rsvg-convert draws PNG files and is not installed; apt install librsvg2-bin, or name the "
            "file .svg");
    if (!status) return fail(file + ": rsvg-convert cannot be started: " + std::strerror(errno));
    if (*status != 0) return fail(file + ": cannot be written");
    return {};
}

}  // namespace asip::sim
