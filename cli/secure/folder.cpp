// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/folder.hpp"
#include "asip/program/kept_file.hpp"
#include "asip/text/file_text.hpp"

#include <fcntl.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

Failure cannot(const std::string& what, const fs::path& path) {
    const int error = errno;
    const bool denied = error == EACCES || error == EPERM;
    return {program::kExitFailure,
            "cannot " + what + " " + path.string() + ": " + std::strerror(error) +
                (denied ? "; the user who made this bus has to do that (root: sudo)" : "")};
}

/// The user that Mosquitto becomes when root starts it.
const passwd* broker_user() {
    return ::geteuid() == 0 ? ::getpwnam("mosquitto") : nullptr;
}

/// Modes are as they stand here, whatever mask the shell gave us: the broker, another user, must be able to
/// read what is meant for it.
class Mask {
  public:
    explicit Mask(mode_t mask) : before_(::umask(mask)) {}
    ~Mask() { ::umask(before_); }
    Mask(const Mask&) = delete;
    Mask& operator=(const Mask&) = delete;

  private:
    mode_t before_;
};
constexpr mode_t kOthersMayNotWrite = 022;

/// Makes the folder unless it exists, and opens it. A folder of another user, or one in which others may
/// write, could be exchanged under our hands for one that leads elsewhere.
Outcome<Descriptor> own_folder(const fs::path& path, mode_t mode, int flags,
                               const passwd* also_of = nullptr) {
    if (::mkdir(path.c_str(), mode) != 0 && errno != EEXIST)
        return tl::unexpected(cannot("make the folder", path));
    Descriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | flags));
    struct stat status{};
    if (!folder.valid() || ::fstat(folder.number(), &status) != 0)
        return tl::unexpected(cannot("open the folder", path));
    if (status.st_uid != ::geteuid() && (also_of == nullptr || status.st_uid != also_of->pw_uid)) {
        return failure(
            program::kExitFailure,
            path.string() +
                " belongs to another user; do this as that user, or in another folder (--dir DIR)");
    }
    if ((status.st_mode & kOthersMayNotWrite) != 0) {
        return failure(program::kExitFailure, "others may write in " + path.string() +
                                                  "; end that first: chmod go-w " + path.string());
    }
    return folder;
}

/// One that no other user looks into.
Outcome<void> private_folder(const fs::path& path, const passwd* owner = nullptr) {
    const auto folder = own_folder(path, 0700, O_NOFOLLOW, owner);
    if (!folder) return tl::unexpected(folder.error());
    if (::fchmod(folder->number(), 0700) != 0) return tl::unexpected(cannot("close to others", path));
    if (owner != nullptr && ::fchown(folder->number(), owner->pw_uid, owner->pw_gid) != 0)
        return tl::unexpected(cannot("give to user mosquitto", path));
    return {};
}

void make_parents(const fs::path& path) {
    std::error_code error;
    if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
}

/// A run that was killed may have left credentials that were not yet in their place.
void remove_unfinished(const fs::path& folder) {
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        std::error_code ignored;
        if (it->path().extension() == ".new") fs::remove(it->path(), ignored);
    }
}

/// Whether the users who should, and no others, can read the file.
bool has_mode(const fs::path& file, mode_t mode) {
    struct stat status{};
    return ::lstat(file.c_str(), &status) == 0 && S_ISREG(status.st_mode) && (status.st_mode & 0777) == mode;
}

}  // namespace

Outcome<SecureFolder> SecureFolder::create(const Path& path) {
    const bool root = ::geteuid() == 0;
    const auto text = path.string();
    if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
        return failure(program::kExitUsage,
                       "the folder's name has control characters; take another (--dir DIR)");
    if (!root) make_parents(path);
    const Mask mask(kOthersMayNotWrite);
    if (root) make_parents(path);
    // The broker, another user, must get to broker/.
    auto lock = own_folder(path, root ? 0755 : 0700, 0);
    if (!lock) return tl::unexpected(lock.error());
    if (::flock(lock->number(), LOCK_EX) != 0) return tl::unexpected(cannot("lock", path));
    if (auto made = private_folder(path / "broker", broker_user()); !made)
        return tl::unexpected(made.error());
    if (auto made = private_folder(path / "credentials"); !made) return tl::unexpected(made.error());
    remove_unfinished(path / "credentials");
    std::error_code error;
    auto whole = fs::canonical(path, error);
    if (error) return failure(program::kExitFailure, "cannot find " + text + ": " + error.message());
    return SecureFolder(std::move(whole), std::move(*lock));
}

Outcome<SecureFolder> SecureFolder::open(const Path& path) {
    if (::access((path / "bus.json").c_str(), R_OK) != 0) {
        if (errno == EACCES) return tl::unexpected(cannot("read", path / "bus.json"));
        return failure(program::kExitFailure, "there is no secured bus in " + path.string() +
                                                  "; make one: asipctl secure init (--dir DIR: elsewhere)");
    }
    return create(path);
}

Outcome<SecuredBus> SecureFolder::bus() const {
    const auto text = text::file_text(bus_file());
    if (!text) return tl::unexpected(cannot("read", bus_file()));
    auto bus = read_bus(*text);
    if (!bus) return failure(program::kExitFailure, bus_file().string() + ": " + bus.error());
    return std::move(*bus);
}

Outcome<CertificateAndKey> SecureFolder::authority_and_key() const {
    auto certificate = text::file_text(authority());
    if (!certificate) return tl::unexpected(cannot("read", authority()));
    auto key = text::file_text(authority_key());
    if (!key) return tl::unexpected(cannot("read the authority's key", authority_key()));
    return CertificateAndKey{std::move(*certificate), std::move(*key)};
}

Outcome<void> SecureFolder::save(const SecuredBus& bus) const {
    const auto written = write(bus_file(), write_bus(bus), Readers::kOwner);
    if (!written) return tl::unexpected(written.error());
    return {};
}

Outcome<bool> SecureFolder::write(const Path& file, const std::string& text, Readers readers) const {
    const mode_t mode = readers == Readers::kOwner ? 0600 : 0644;
    if (has_mode(file, mode) && text::file_text(file) == text) return false;
    program::FileRights rights{mode};
    if (const auto* user = broker_user(); user != nullptr && for_broker(file))
        rights = {mode, user->pw_uid, user->pw_gid};
    if (!program::replace_file(file, text, rights)) return tl::unexpected(cannot("write", file));
    return true;
}

}  // namespace asip::cli
