// SPDX-License-Identifier: Apache-2.0
// Preloaded into a program: while the file ASIP_STALL exists, nothing that it writes at a place of a file
// gets to the disk. The file ASIP_STALL.met says that it has begun to wait.
#include <dlfcn.h>
#include <sys/types.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

namespace {

void stall() {
    static const char* const file = std::getenv("ASIP_STALL");
    if (file == nullptr || ::access(file, F_OK) != 0) return;
    if (FILE* met = std::fopen((std::string(file) + ".met").c_str(), "w")) std::fclose(met);
    constexpr timespec kPause{0, 10'000'000};
    while (::access(file, F_OK) == 0)
        ::nanosleep(&kPause, nullptr);
}

template <class Function>
Function* real(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int fsync(int file) {
    stall();
    return real<int(int)>("fsync")(file);
}

int fdatasync(int file) {
    stall();
    return real<int(int)>("fdatasync")(file);
}

ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
    stall();
    return real<ssize_t(int, const void*, size_t, off_t)>("pwrite")(file, bytes, count, at);
}

ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t at) {
    stall();
    return real<ssize_t(int, const void*, size_t, off64_t)>("pwrite64")(file, bytes, count, at);
}

}  // extern "C"
