// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/line_history.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <system_error>

#include "cli/shell/shell_words.hpp"

namespace asip::cli {
namespace fs = std::filesystem;
namespace {

/// An open file, locked against other shells.
class LockedFile {
  public:
    explicit LockedFile(const fs::path& path)
        : descriptor_(open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600)) {
        struct stat info{};
        ok_ = descriptor_ >= 0 && fstat(descriptor_, &info) == 0 && S_ISREG(info.st_mode) &&
              flock(descriptor_, LOCK_EX) == 0;
    }
    ~LockedFile() {
        if (descriptor_ >= 0) close(descriptor_);
    }
    LockedFile(const LockedFile&) = delete;
    LockedFile& operator=(const LockedFile&) = delete;

    explicit operator bool() const { return ok_; }
    bool append(const std::string& text) const {
        return write(descriptor_, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    }
    bool replace(const std::string& text) const { return ftruncate(descriptor_, 0) == 0 && append(text); }

  private:
    int descriptor_;
    bool ok_ = false;
};

std::vector<std::string> read_lines(const fs::path& file, std::size_t newest) {
    std::vector<std::string> result;
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return result;
    std::ifstream input(file);
    for (std::string line; std::getline(input, line);) {
        if (!line.empty() && shell_words(line)) result.push_back(std::move(line));
        if (result.size() >= 2 * newest)
            result.erase(result.begin(), result.end() - static_cast<std::ptrdiff_t>(newest));
    }
    if (result.size() > newest)
        result.erase(result.begin(), result.end() - static_cast<std::ptrdiff_t>(newest));
    return result;
}

std::size_t count_lines(const fs::path& file) {
    std::ifstream input(file);
    return static_cast<std::size_t>(
        std::count(std::istreambuf_iterator<char>(input), std::istreambuf_iterator<char>(), '\n'));
}

}  // namespace

fs::path LineHistory::file_of_user(const Variables& variables) {
    if (const auto folder = variables("XDG_STATE_HOME"); folder && folder->starts_with("/"))
        return fs::path(*folder) / "asipctl" / "history";
    if (const auto home = variables("HOME"); home && !home->empty())
        return fs::path(*home) / ".local" / "state" / "asipctl" / "history";
    return {};
}

std::vector<std::string> LineHistory::lines() const {
    return file_.empty() ? std::vector<std::string>() : read_lines(file_, kMaxLines);
}

bool LineHistory::add(const std::string& line) const {
    if (line.empty() || line.front() == ' ' || file_.empty()) return true;
    std::error_code error;
    fs::create_directories(file_.parent_path(), error);
    const LockedFile file(file_);
    if (!file) return false;
    if (count_lines(file_) < 2 * kMaxLines) return file.append(line + "\n");
    std::string text;
    for (const auto& kept : read_lines(file_, kMaxLines - 1))
        text += kept + "\n";
    return file.replace(text + line + "\n");
}

}  // namespace asip::cli
