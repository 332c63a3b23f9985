// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string_view>

namespace asip::gateway {

/// Built into the program.
struct PageFile {
    std::string_view path;  ///< "index.html", "js/app.js"
    std::string_view gzip;  ///< compressed content
    std::string_view etag;  ///< from the content
};
/// Unordered; made from page/files.txt.
std::span<const PageFile> page_files();

}  // namespace asip::gateway
