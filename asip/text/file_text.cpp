// SPDX-License-Identifier: Apache-2.0
#include "asip/text/file_text.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

namespace asip::text {

Expected<std::string> file_text(const std::filesystem::path& file) {
    std::error_code unknown;
    if (std::filesystem::is_directory(file, unknown)) return fail("is a folder");
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return fail(std::strerror(errno));
    try {
        return std::string(std::istreambuf_iterator<char>(stream), {});
    } catch (const std::ios_base::failure&) {  // of the buffer: the stream's own exceptions are off
        return fail("cannot be read to its end");
    }
}

}  // namespace asip::text
