// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cli/environment.hpp"

/// What a backup has: which files of a machine, by place and path. Whatever a list says, no other is read or
/// written.
namespace asip::cli {

enum class Place {
    kEtc,        ///< /etc/asip: configuration, tokens, and the keys and users of `asipctl secure`
    kMosquitto,  ///< /etc/mosquitto/conf.d: the files of ours
    kState,      ///< /var/lib/asip: labels, links, stops, history and values
    kDashboard   ///< retained on the bus
};

struct BackupItem {
    Place place = Place::kEtc;
    std::string path;
    mode_t mode = 0600;
    std::int64_t changed = 0;  ///< nanoseconds since 1970
    std::uint64_t size = 0;
    std::uint64_t at = 0;  ///< where it begins in a backup that is read
    bool closed = false;   ///< in a folder that the other users may not enter; no list says so

    /// Keys, users, and what the other users of the machine may not read either.
    bool is_secret() const;
    /// Copied by SQLite, since a program may write it meanwhile.
    bool is_database() const;
    /// That a backup may have it.
    bool valid() const;
};

inline constexpr std::size_t kMaxListBytes = std::size_t{16} << 20, kMaxItems = 50'000;
inline constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20;  ///< of all but databases

/// A line about it, such as where and when it was made; one for each item, in the order of their contents;
/// an empty one.
std::string to_text(const std::string& about, const std::vector<BackupItem>& items);
struct BackupList {
    std::string about;
    std::vector<BackupItem> items;
};
/// `begin`: of a text of so many bytes. Fails on anything that to_text() does not write.
Outcome<BackupList> read_list(const std::string& begin, std::uint64_t bytes, bool sealed);

}  // namespace asip::cli
