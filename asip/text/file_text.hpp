// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::text {

/// The whole file. Error: why it cannot be read.
Expected<std::string> file_text(const std::filesystem::path& file);

/// Without the mark that some editors put before UTF-8.
inline std::string_view without_mark(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    return text;
}
/// It is to be saved as UTF-8.
inline bool is_utf16(std::string_view text) {
    return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
}

}  // namespace asip::text
