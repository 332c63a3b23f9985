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

#include "asip/program/descriptor.hpp"

namespace asip::program {
namespace {

namespace fs = std::filesystem;

Unexpected<std::string> failed(const fs::path& path) {
    return fail(path.string() + " cannot be written: " + std::strerror(errno));
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
    return sync_folder(path.has_parent_path() ? path.parent_path() : fs::path("."));
}

}  // namespace

Expected<void> keep_file(const fs::path& path, std::string_view text) {
    const auto folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!make_folder(folder)) return failed(folder);
    auto unfinished = path;
    unfinished += ".new";
    {
        ::unlink(unfinished.c_str());  // what a killed program left, or another user planted
        const Descriptor file(::open(unfinished.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
        if (!file.valid() || !file.write(text) || !file.sync()) return failed(unfinished);
    }
    if (::rename(unfinished.c_str(), path.c_str()) != 0 || !sync_folder(folder)) return failed(path);
    return {};
}

Expected<void> drop_file(const fs::path& path) {
    std::error_code error;
    if (!fs::remove(path, error) && !error) return {};
    if (error) return fail(path.string() + ": " + error.message());
    if (!sync_folder(path.has_parent_path() ? path.parent_path() : fs::path("."))) return failed(path);
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
