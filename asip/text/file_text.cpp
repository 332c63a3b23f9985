// SPDX-License-Identifier: Apache-2.0
#include "cli/file_text.hpp"

#include <fstream>
#include <iterator>

namespace asip::cli {

std::optional<std::string> file_text(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return std::nullopt;
    try {
        return std::string(std::istreambuf_iterator<char>(stream), {});
    } catch (const std::ios_base::failure&) {  // of the buffer: the stream's own exceptions are off
        return std::nullopt;
    }
}

}  // namespace asip::cli
