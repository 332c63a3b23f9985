// SPDX-License-Identifier: Apache-2.0
#include "cli/backup/machine.hpp"

#include <fcntl.h>
#include <grp.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <tuple>

#include "asip/program/kept_file.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kOthersWrite = 022, kGroupReads = 040, kAllRead = 004;
constexpr std::int64_t kNanoseconds = 1'000'000'000;
constexpr int kMaxDepth = 4;

/// As the packages and asipctl secure make them.
mode_t folder_mode(const BackupItem& folder) {
    if (folder.place == Place::kState || folder.path == "bus/broker" || folder.path == "bus/credentials")
        return 0700;
    return folder.path == "credentials" ? 0750 : 0755;
}

void must(int result) {
    if (result != 0) throw std::runtime_error("cannot become another user");
}

tl::unexpected<Failure> unable_to(const std::string& what, const std::string& name) {
    return failure(program::kExitFailure, "cannot " + what + " " + name + ": " + std::strerror(errno) +
                                              (errno == EACCES ? " (root may: sudo)" : ""));
}

bool in_closed_folder(const std::string& name) {
    struct stat status{};
    for (auto slash = name.rfind('/'); slash != std::string::npos && slash > 0;
         slash = name.rfind('/', slash - 1))
        if (::stat(name.substr(0, slash).c_str(), &status) != 0 || (status.st_mode & S_IXOTH) == 0)
            return true;
    return false;
}

/// Calls `found` for each file; what is removed meanwhile is not there.
Outcome<void> each_file(const std::string& folder, int levels,
                        const std::function<void(const std::string& name, const struct stat&)>& found) {
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        const auto name = it->path().string();
        struct stat status{};
        if (::lstat(name.c_str(), &status) != 0) continue;
        if (!S_ISDIR(status.st_mode)) {
            found(name, status);
        } else if (levels > 0) {
            if (auto done = each_file(name, levels - 1, found); !done) return done;
        }
    }
    if (!error || error == std::errc::no_such_file_or_directory) return {};
    errno = error.value();
    return unable_to("read", folder);
}

}  // namespace

AsUser::AsUser(const Owner& owner) {
    if (::geteuid() != 0 || owner.user == 0) return;
    groups_.resize(static_cast<std::size_t>(std::max(0, ::getgroups(0, nullptr))));
    must(::getgroups(static_cast<int>(groups_.size()), groups_.data()) < 0 ? 1 : 0);
    changed_ = true;
    must(::setgroups(0, nullptr));
    must(::setegid(owner.group));
    must(::seteuid(owner.user));
}

AsUser::~AsUser() {
    if (changed_ &&
        (::seteuid(0) != 0 || ::setegid(::getgid()) != 0 || ::setgroups(groups_.size(), groups_.data()) != 0))
        std::terminate();
}

Outcome<BackupMachine> BackupMachine::open(const BackupPaths& paths) {
    BackupMachine made;
    const std::array<std::string, 3> all{paths.etc, paths.mosquitto, paths.state};
    for (std::size_t i = 0; i < all.size(); ++i) {
        struct stat status{};
        if (::stat(all[i].c_str(), &status) != 0 && errno == ENOENT) continue;
        std::error_code error;
        made.paths_[i] = fs::canonical(all[i], error).string();
        if (error || ::stat(made.paths_[i].c_str(), &status) != 0) return unable_to("open", all[i]);
        const bool foreign = i != static_cast<std::size_t>(Place::kState) && status.st_uid != ::geteuid();
        if (foreign || (status.st_mode & kOthersWrite) != 0)
            return failure(program::kExitFailure,
                           all[i] + (foreign ? " belongs to another user: do this as that one (root: sudo)"
                                             : ": others may write there; end that first: chmod go-w"));
        made.owners_[i] = {status.st_uid, status.st_gid};
    }
    return made;
}

std::string BackupMachine::name_of(const BackupItem& item) const {
    if (item.place == Place::kDashboard) return "dashboard " + item.path;
    return paths_.at(static_cast<std::size_t>(item.place)) + "/" + item.path;
}

Owner BackupMachine::owner_of(const BackupItem& item) const {
    auto owner = owners_.at(static_cast<std::size_t>(item.place));
    if (item.place != Place::kEtc) return owner;
    const bool of_broker = item.path == "bus/broker" || item.path.starts_with("bus/broker/");
    if (const auto* user = of_broker && ::getuid() == 0 ? ::getpwnam("mosquitto") : nullptr)
        return {user->pw_uid, user->pw_gid};
    // The services read it.
    if (has(Place::kState) &&
        (item.path == "credentials" || (item.mode & (kGroupReads | kAllRead)) == kGroupReads))
        owner.group = owners_.at(static_cast<std::size_t>(Place::kState)).group;
    return owner;
}

/// From above to below, so that no other user exchanges one that was seen.
Outcome<bool> BackupMachine::folders(const BackupItem& item, bool make) const {
    for (auto slash = item.path.find('/'); slash != std::string::npos;
         slash = item.path.find('/', slash + 1)) {
        const BackupItem folder{item.place, item.path.substr(0, slash)};
        const auto name = name_of(folder);
        const auto owner = owner_of(folder);
        const bool made = make && ::mkdir(name.c_str(), 0700) == 0;
        if (made && ::geteuid() == 0 && ::chown(name.c_str(), owner.user, owner.group) != 0)
            return unable_to("make", name);
        if (made && ::chmod(name.c_str(), folder_mode(folder)) != 0) return unable_to("make", name);
        struct stat status{};
        if (::lstat(name.c_str(), &status) != 0)
            return errno == ENOENT ? Outcome<bool>(false) : unable_to("open", name);
        const bool ours = status.st_uid == owner.user ||
                          status.st_uid == owners_.at(static_cast<std::size_t>(item.place)).user;
        if (!S_ISDIR(status.st_mode) || !ours || (status.st_mode & kOthersWrite) != 0)
            return failure(program::kExitFailure, name + " is no folder of its owner alone");
    }
    return true;
}

Outcome<void> BackupMachine::check(const struct stat& status, const BackupItem& item) const {
    const bool own = status.st_uid == owner_of(item).user;
    if (S_ISREG(status.st_mode) && own && status.st_nlink == 1) return {};
    return failure(program::kExitFailure, name_of(item) + (!S_ISREG(status.st_mode) ? " is no plain file"
                                                           : own                    ? " has a second name"
                                                                 : " belongs to another user"));
}

Outcome<std::optional<struct stat>> BackupMachine::look(const BackupItem& item) const {
    const AsUser as(user_for(item));
    const auto found = folders(item, false);
    if (!found) return tl::unexpected(found.error());
    struct stat status{};
    const auto name = name_of(item);
    if (!*found || (::lstat(name.c_str(), &status) != 0 && errno == ENOENT)) return std::nullopt;
    if (const auto good = check(status, item); !good) return tl::unexpected(good.error());
    return status;
}

Outcome<std::optional<std::string>> BackupMachine::read(const BackupItem& item) const {
    const AsUser as(user_for(item));
    const auto name = name_of(item);
    const Descriptor file(::open(name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    struct stat status{};
    if (!file.valid() && errno == ENOENT) return std::nullopt;
    if (!file.valid() || ::fstat(file.number(), &status) != 0) return unable_to("read", name);
    if (status.st_nlink == 0) return std::nullopt;  // it was removed since it is open
    if (const auto good = check(status, item); !good) return tl::unexpected(good.error());
    std::string text(kMaxFileBytes + 1, '\0');
    std::size_t done = 0;
    for (ssize_t count = 1; count > 0 && done < text.size(); done += static_cast<std::size_t>(count))
        if (count = ::read(file.number(), text.data() + done, text.size() - done); count < 0)
            return unable_to("read", name);
    text.resize(done);
    return text;
}

Outcome<void> BackupMachine::write(const BackupItem& item, const std::string& text) const {
    const auto owner = owner_of(item);
    const auto name = name_of(item);
    const auto in_folders = [&] {
        const AsUser as(item.place == Place::kState ? owner : Owner{});
        return folders(item, true);
    }();
    if (!in_folders) return tl::unexpected(in_folders.error());
    const AsUser as(user_for(item));
    if (const auto kept = program::keep_file(name, text); !kept)
        return failure(program::kExitFailure, kept.error());
    const timespec at{item.changed / kNanoseconds, item.changed % kNanoseconds};
    const std::array<timespec, 2> times{at, at};
    if ((::geteuid() == 0 && ::chown(name.c_str(), owner.user, owner.group) != 0) ||
        ::chmod(name.c_str(), item.mode) != 0 ||
        ::utimensat(AT_FDCWD, name.c_str(), times.data(), AT_SYMLINK_NOFOLLOW) != 0)
        return unable_to("write", name);
    return {};
}

Outcome<std::vector<BackupItem>> BackupMachine::list(
    const std::function<void(const std::string&)>& left_out) const {
    std::vector<BackupItem> items;
    for (const auto place : {Place::kEtc, Place::kMosquitto, Place::kState}) {
        if (!has(place)) continue;
        const AsUser as(place == Place::kState ? owner_of({place, ""}) : Owner{});
        const auto& top = paths_.at(static_cast<std::size_t>(place));
        const auto found = [&](const std::string& name, const struct stat& status) {
            BackupItem item{place, name.substr(top.size() + 1)};
            item.mode = status.st_mode & 0644;
            item.changed =
                std::max<std::int64_t>(0, status.st_mtim.tv_sec * kNanoseconds + status.st_mtim.tv_nsec);
            item.closed = in_closed_folder(name);
            if (!item.valid()) return;
            const auto plain = look(item);
            plain ? items.push_back(std::move(item)) : left_out(plain.error().text);
        };
        if (const auto done = each_file(top, kMaxDepth, found); !done) return tl::unexpected(done.error());
    }
    std::sort(items.begin(), items.end(), [](const auto& a, const auto& b) {
        return std::tie(a.place, a.path) < std::tie(b.place, b.path);
    });
    return items;
}

}  // namespace asip::cli
