// SPDX-License-Identifier: Apache-2.0
#include "gateway/replaced_file.hpp"

#include <fcntl.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace asip::gateway {
namespace {

constexpr const char* kServiceGroup = "asip";  // as the packages make it

// The owner alone may read a new file. Made by root it belongs to the group of the service, too, which
// runs as a user of its own; a file that was there keeps its owner and its rights.
struct Owner {
    uid_t user = geteuid();
    gid_t group = getegid();
    mode_t mode = 0600;
};

Owner owner_of(const std::string& path) {
    struct stat found{};
    if (stat(path.c_str(), &found) == 0)
        return {found.st_uid, found.st_gid, static_cast<mode_t>(found.st_mode & 07777)};
    Owner owner;
    const group* service = geteuid() == 0 ? getgrnam(kServiceGroup) : nullptr;
    if (service != nullptr) owner.group = service->gr_gid, owner.mode = 0640;
    return owner;
}

bool write_whole(int file, std::string_view text) {
    while (!text.empty()) {
        const auto written = write(file, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        text.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

}  // namespace

bool replace_file(const std::string& path, const std::string& text) {
    const auto target = std::filesystem::weakly_canonical(path).string();  // a link stays one
    const auto owner = owner_of(target);
    std::string draft = target + ".XXXXXX";
    const int file = mkostemp(draft.data(), O_CLOEXEC);
    if (file < 0) return false;
    struct stat made{};
    const bool same = fstat(file, &made) == 0 && made.st_uid == owner.user && made.st_gid == owner.group;
    const bool done = (same || fchown(file, owner.user, owner.group) == 0) && fchmod(file, owner.mode) == 0 &&
                      write_whole(file, text) && fsync(file) == 0;
    if (close(file) == 0 && done && rename(draft.c_str(), target.c_str()) == 0) return true;
    unlink(draft.c_str());
    return false;
}

}  // namespace asip::gateway
