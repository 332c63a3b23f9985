// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace asip::gateway {

/// Written beside the file and renamed: readers find the old one or the new one, whole. Owner and rights
/// stay. False: nothing changed, see errno.
bool replace_file(const std::string& path, const std::string& text);

}  // namespace asip::gateway
