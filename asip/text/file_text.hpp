// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace asip::cli {

/// The whole file; nothing when it cannot be read: it is not there, it is a folder, or its process has ended.
std::optional<std::string> file_text(const std::filesystem::path& file);

}  // namespace asip::cli
