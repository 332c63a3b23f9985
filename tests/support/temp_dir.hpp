// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace asip::test {

/// A folder of its own for a test, gone when the test is.
class TempDir {
  public:
    TempDir();
    ~TempDir();
    TempDir(const TempDir&) = delete;
    TempDir& operator=(const TempDir&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Path of a file below it.
    std::string file(std::string_view name) const { return (path_ / name).string(); }
    /// Writes a file below it and returns its path.
    std::string write(std::string_view name, std::string_view content) const;

  private:
    std::filesystem::path path_;
};

/// Writes a configuration file for the option --config, which is there until this process ends. Returns its
/// path.
std::string settings_file(std::string_view text);

/// A TCP port of 127.0.0.1 that is free now; none of those that the kernel may give to another connection
/// before it is used.
std::uint16_t free_port();
/// Whether a program accepts TCP connections there.
bool accepts(std::uint16_t port);

}  // namespace asip::test
