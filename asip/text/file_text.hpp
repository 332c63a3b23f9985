// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "asip/expected.hpp"

namespace asip::text {

/// The whole file, or in words why it cannot be read: it is not there, it is a folder, its process has ended.
Expected<std::string> file_text(const std::filesystem::path& file);

}  // namespace asip::text
