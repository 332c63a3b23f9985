// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace asip::gateway {

/// Written beside the file and renamed: a program that reads it meanwhile finds the old one or the new one,
/// whole. A file that was there keeps its owner and its rights. False: it is as it was, and errno says why.
bool replace_file(const std::string& path, const std::string& text);

}  // namespace asip::gateway
