#include "cli/secure/folder.hpp"

#include <fcntl.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

Failure cannot(const std::string& what, const fs::path& path) {
    const int error = errno;
    const bool denied = error == EACCES || error == EPERM;
    return {program::kExitFailure, "cannot " + what + " " + path.string() + ": " + std::strerror(error) +
                                       (denied ? "; whoever made this bus has to do that (root: sudo)" : "")};
}

/// The user that Mosquitto becomes when root starts it.
const passwd* broker_user() {
    return ::geteuid() == 0 ? ::getpwnam("mosquitto") : nullptr;
}

Outcome<void> make_folder(const fs::path& path, mode_t mode) {
    if (::mkdir(path.c_str(), mode) == 0) return {};
    if (errno == EEXIST && fs::is_directory(path)) return {};
    return tl::unexpected(cannot("make the folder", path));
}

bool write_all(int file, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const auto count = ::write(file, text.data() + done, text.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        done += static_cast<std::size_t>(count);
    }
    return ::fsync(file) == 0;
}

}  // namespace

std::optional<std::string> file_text(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return std::nullopt;
    return std::string(std::istreambuf_iterator<char>(stream), {});
}

Outcome<SecureFolder> SecureFolder::create(const Path& path) {
    const bool root = ::geteuid() == 0;
    std::error_code error;
    if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
    // The broker, another user, must get to broker/.
    if (auto made = make_folder(path, root ? 0755 : 0700); !made) return tl::unexpected(made.error());
    if (auto made = make_folder(path / "broker", 0700); !made) return tl::unexpected(made.error());
    if (auto made = make_folder(path / "credentials", 0700); !made) return tl::unexpected(made.error());
    if (const auto* user = broker_user();
        user != nullptr && ::chown((path / "broker").c_str(), user->pw_uid, user->pw_gid) != 0)
        return tl::unexpected(cannot("give to user mosquitto", path / "broker"));
    const int lock = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock < 0 || ::flock(lock, LOCK_EX) != 0) return tl::unexpected(cannot("lock", path));
    return SecureFolder(fs::canonical(path), lock);
}

Outcome<SecureFolder> SecureFolder::open(const Path& path) {
    if (::access((path / "bus.json").c_str(), R_OK) != 0) {
        if (errno == EACCES) return tl::unexpected(cannot("read", path / "bus.json"));
        return failure(program::kExitFailure, "there is no secured bus in " + path.string() +
                                                  "; make one: asipctl secure init (--dir DIR: elsewhere)");
    }
    return create(path);
}

SecureFolder::SecureFolder(SecureFolder&& other) noexcept
    : path_(std::move(other.path_)), lock_(std::exchange(other.lock_, -1)) {}

SecureFolder::~SecureFolder() {
    if (lock_ >= 0) ::close(lock_);
}

Outcome<SecuredBus> SecureFolder::bus() const {
    const auto text = file_text(bus_file());
    if (!text) return tl::unexpected(cannot("read", bus_file()));
    auto bus = read_bus(*text);
    if (!bus) return failure(program::kExitFailure, bus_file().string() + ": " + bus.error());
    return std::move(*bus);
}

Outcome<CertificateAndKey> SecureFolder::authority_and_key() const {
    auto certificate = file_text(authority());
    if (!certificate) return tl::unexpected(cannot("read", authority()));
    auto key = file_text(authority_key());
    if (!key) return tl::unexpected(cannot("read the authority's key", authority_key()));
    return CertificateAndKey{std::move(*certificate), std::move(*key)};
}

Outcome<void> SecureFolder::save(const SecuredBus& bus) const {
    const auto written = write(bus_file(), write_bus(bus), Readers::kOwner);
    if (!written) return tl::unexpected(written.error());
    return {};
}

Outcome<bool> SecureFolder::write(const Path& file, const std::string& text, Readers readers) const {
    if (file_text(file) == text) return false;
    const auto temporary = file.string() + ".new";
    ::unlink(temporary.c_str());
    const int opened = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC,
                              readers == Readers::kOwner ? 0600 : 0644);
    if (opened < 0) return tl::unexpected(cannot("write", file));
    bool done = write_all(opened, text);
    if (const auto* user = broker_user(); done && user != nullptr && for_broker(file))
        done = ::fchown(opened, user->pw_uid, user->pw_gid) == 0;
    const int error = errno;
    ::close(opened);
    errno = error;
    if (!done || ::rename(temporary.c_str(), file.c_str()) != 0) {
        auto why = cannot("write", file);
        ::unlink(temporary.c_str());
        return tl::unexpected(std::move(why));
    }
    return true;
}

}  // namespace asip::cli
