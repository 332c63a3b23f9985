// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string_view>

namespace asip::gateway {

/// A file of the web page, built into the program: of static storage, and never changed.
struct PageFile {
    std::string_view path;  ///< "index.html", "js/app.js"
    std::string_view gzip;  ///< compressed content
    std::string_view etag;  ///< from the content
};
/// All of them, by no order. The build makes this from page/files.txt.
std::span<const PageFile> page_files();

}  // namespace asip::gateway
