// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/stat.h>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "asip/descriptor.hpp"
#include "cli/backup/items.hpp"

namespace asip::cli {

struct Owner {
    uid_t user = 0;
    gid_t group = 0;
};

/// For its lifetime root is this user and nothing more.
class AsUser {
  public:
    explicit AsUser(const Owner& owner);
    ~AsUser();
    AsUser(const AsUser&) = delete;
    AsUser& operator=(const AsUser&) = delete;

  private:
    std::vector<gid_t> groups_;
    bool changed_ = false;
};

struct BackupPaths {
    std::string etc = "/etc/asip", mosquitto = "/etc/mosquitto/conf.d", state = "/var/lib/asip";
};
class Declaration;
/// Options that name other folders.
void declare_paths(Declaration& verb, BackupPaths& paths);

/// The files of this machine. Where another user than this one may change a folder (the state of the
/// services, the files of the broker), all is done as that user: what that one planted there leads no further
/// than that one may go. Only plain files of the user who should have them are taken.
class BackupMachine {
  public:
    /// A folder that is missing has nothing. Fails for one in which yet another may write.
    static Outcome<BackupMachine> open(const BackupPaths& paths);

    bool has(Place place) const { return !paths_.at(static_cast<std::size_t>(place)).empty(); }
    std::string name_of(const BackupItem& item) const;
    /// `left_out` gets those that are not as they should be.
    Outcome<std::vector<BackupItem>> list(const std::function<void(const std::string& why)>& left_out) const;
    /// Nothing: there is none. Fails where it is something else than a file of its owner.
    Outcome<std::optional<struct stat>> look(const BackupItem& item) const;
    /// A file above kMaxFileBytes gives one byte more than that. Nothing: there is none.
    Outcome<std::optional<std::string>> read(const BackupItem& item) const;
    /// Whole or not at all, with mode and time of the item; folders are made.
    Outcome<void> write(const BackupItem& item, const std::string& text) const;

    /// A database as it is at one moment, in a file that has no name any more.
    Outcome<Descriptor> copy_database(const BackupItem& item) const;
    /// Whether the one here began before that of the backup ended, and goes on behind it, or cannot be read.
    bool goes_on_here(const BackupItem& item) const;
    /// In place of all that is in it, whole or not at all. Fails where another program has it open.
    Outcome<void> restore_database(const BackupItem& item, const Descriptor& text) const;

  private:
    Owner owner_of(const BackupItem& item) const;
    /// Who may change the folder of the item.
    Owner user_for(const BackupItem& item) const {
        return owner_of({item.place, item.path.substr(0, item.path.rfind('/'))});
    }
    /// Those above the item; false: one is missing.
    Outcome<bool> folders(const BackupItem& item, bool make) const;
    Outcome<void> check(const struct stat& status, const BackupItem& item) const;

    std::array<std::string, 3> paths_;  // empty: there is none
    std::array<Owner, 3> owners_{};
};

}  // namespace asip::cli
