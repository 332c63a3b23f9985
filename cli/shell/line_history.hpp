// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace asip::cli {

/// Lines that were typed, in a file that only its user may read. Several shells may use it at a time; a line
/// is there as soon as add() returns.
class LineHistory {
  public:
    /// Lines that are given back; the file holds at most twice as many.
    static constexpr std::size_t kMaxLines = 1000;

    /// An empty path keeps nothing.
    explicit LineHistory(std::filesystem::path file) : file_(std::move(file)) {}

    /// `$XDG_STATE_HOME/asipctl/history`, else `~/.local/state/asipctl/history`; empty where there is
    /// neither.
    using Variables = std::function<std::optional<std::string>(const std::string&)>;
    static std::filesystem::path file_of_user(const Variables& variables);

    const std::filesystem::path& file() const { return file_; }

    /// The newest kMaxLines, the oldest first. What is not text is left out.
    std::vector<std::string> lines() const;
    /// False: it could not be kept. A line that is empty or begins with a blank is not kept on purpose.
    bool add(const std::string& line) const;

  private:
    std::filesystem::path file_;
};

}  // namespace asip::cli
