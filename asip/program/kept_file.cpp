// SPDX-License-Identifier: Apache-2.0
#include "asip/program/kept_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>

#include "asip/descriptor.hpp"

namespace asip::program {
namespace {

namespace fs = std::filesystem;

Unexpected<std::string> failed(const fs::path& path) {
    return fail(path.string() + " cannot be written: " + std::strerror(errno));
}

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

bool sync_folder(const fs::path& path) {
    const Descriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    return folder.valid() && folder.sync();
}

// A new folder is on the disk only when the one above it is.
bool make_folder(const fs::path& path) {
    if (::access(path.c_str(), F_OK) == 0) return true;
    if (path.has_parent_path() && path.parent_path() != path && !make_folder(path.parent_path()))
        return false;
    if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST) return false;
    return sync_folder(folder_of(path));
}

bool write_draft(const fs::path& draft, std::string_view text, const FileRights& rights) {
    const Descriptor file(::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    return file.valid() && file.write(text) && ::fchown(file.number(), rights.user, rights.group) == 0 &&
           ::fchmod(file.number(), rights.mode) == 0 && file.sync();
}

}  // namespace

bool replace_file(const fs::path& path, std::string_view text, const FileRights& rights) {
    auto draft = path;
    draft += ".new";
    ::unlink(draft.c_str());  // what a killed program left, or another user planted
    if (write_draft(draft, text, rights) && ::rename(draft.c_str(), path.c_str()) == 0)
        return sync_folder(folder_of(path));
    const int why = errno;
    ::unlink(draft.c_str());
    errno = why;
    return false;
}

Expected<void> keep_file(const fs::path& path, std::string_view text) {
    const auto folder = folder_of(path);
    if (!make_folder(folder)) return failed(folder);
    if (!replace_file(path, text)) return failed(path);
    return {};
}

Expected<void> drop_file(const fs::path& path) {
    std::error_code error;
    if (!fs::remove(path, error) && !error) return {};
    if (error) return fail(path.string() + ": " + error.message());
    if (!sync_folder(folder_of(path))) return failed(path);
    return {};
}

Expected<std::optional<std::string>> read_kept_file(const fs::path& path, std::size_t max_bytes) {
    errno = 0;
    std::ifstream stream(path, std::ios::binary);
    if (!stream && (errno == ENOENT || errno == ENOTDIR)) return std::optional<std::string>();
    if (!stream) return fail(path.string() + ": " + std::strerror(errno));
    std::string text(max_bytes + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (stream.bad()) return fail(path.string() + ": cannot be read");
    text.resize(static_cast<std::size_t>(stream.gcount()));
    return std::optional(std::move(text));
}

}  // namespace asip::program
