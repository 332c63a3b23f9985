// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::program {

/// A file that takes the place of another gets these. -1: the owner or group that each new file of this
/// program has.
struct FileRights {
    mode_t mode = 0600;
    uid_t user = static_cast<uid_t>(-1);
    gid_t group = static_cast<gid_t>(-1);
};

/// Writes a small file so that it is whole, or as it was before, whenever the program or the machine dies;
/// returns when it is on the disk. One writer at a time for each file: it is written as PATH.new first.
/// False: see errno.
bool replace_file(const std::filesystem::path& path, std::string_view text, const FileRights& rights = {});

/// The same. Folders that are missing are made, for their owner alone; so is the file. Fails with the file
/// and the reason.
Expected<void> keep_file(const std::filesystem::path& path, std::string_view text);

/// Removes it; returns when that is on the disk. Where there is none, nothing is done. Fails with the file
/// and the reason.
Expected<void> drop_file(const std::filesystem::path& path);

/// What keep_file() wrote; nothing where there is no such file. Of a longer one `max_bytes` and one more are
/// read, so that its reader sees it. Fails with the file and the reason.
Expected<std::optional<std::string>> read_kept_file(const std::filesystem::path& path, std::size_t max_bytes);

}  // namespace asip::program
