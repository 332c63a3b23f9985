// SPDX-License-Identifier: Apache-2.0
#include "gateway/replaced_file.hpp"

#include <fcntl.h>
#include <grp.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "asip/descriptor.hpp"
#include "asip/program/kept_file.hpp"

namespace asip::gateway {

bool replace_file(const std::string& path, const std::string& text) {
    const auto target = std::filesystem::weakly_canonical(path);  // a link stays one
    // Two users may make a token at the same moment.
    const Descriptor folder(
        ::open(std::filesystem::absolute(target).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!folder.valid() || ::flock(folder.number(), LOCK_EX) != 0) return false;
    struct stat found{};
    if (stat(target.c_str(), &found) == 0)
        return program::replace_file(
            target, text, {static_cast<mode_t>(found.st_mode & 07777), found.st_uid, found.st_gid});
    // Made by root it belongs to the group of the service, too, which runs as a user of its own.
    const group* service = geteuid() == 0 ? getgrnam("asip") : nullptr;
    program::FileRights rights;
    if (service != nullptr) rights.group = service->gr_gid, rights.mode = 0640;
    return program::replace_file(target, text, rights);
}

}  // namespace asip::gateway
