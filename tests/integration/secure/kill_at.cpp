// SPDX-License-Identifier: Apache-2.0
// Preloaded into a program: kills it just before the call number ASIP_KILL_AT of those that change files.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <csignal>
#include <cstdarg>
#include <cstdlib>

namespace {

void step() {
    static int left = [] {
        const char* text = std::getenv("ASIP_KILL_AT");
        return text == nullptr ? 0 : std::atoi(text);
    }();
    if (left > 0 && --left == 0) ::kill(::getpid(), SIGKILL);
}

template <class Function>
Function* real(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int mkdir(const char* path, mode_t mode) noexcept {
    step();
    return real<int(const char*, mode_t)>("mkdir")(path, mode);
}

int rename(const char* from, const char* to) noexcept {
    step();
    return real<int(const char*, const char*)>("rename")(from, to);
}

int unlink(const char* path) noexcept {
    step();
    return real<int(const char*)>("unlink")(path);
}

int remove(const char* path) noexcept {
    step();
    return real<int(const char*)>("remove")(path);
}

int fsync(int file) {
    step();
    return real<int(int)>("fsync")(file);
}

int fchmod(int file, mode_t mode) noexcept {
    step();
    return real<int(int, mode_t)>("fchmod")(file, mode);
}

int fchown(int file, uid_t user, gid_t group) noexcept {
    step();
    return real<int(int, uid_t, gid_t)>("fchown")(file, user, group);
}

int open(const char* path, int flags, ...) {
    mode_t mode = 0;
    if ((flags & O_CREAT) != 0) {
        va_list arguments;
        va_start(arguments, flags);
        mode = va_arg(arguments, mode_t);
        va_end(arguments);
        step();
    }
    return real<int(const char*, int, mode_t)>("open")(path, flags, mode);
}

}  // extern "C"
