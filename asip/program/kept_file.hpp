// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::program {

/// Writes a small file so that it is whole, or as it was before, whenever the program or the machine dies;
/// returns when it is on the disk. Folders that are missing are made, for their owner alone; so is the file.
/// One writer at a time for each file: it is written as PATH.new first. Fails with the file and the reason.
Expected<void> keep_file(const std::filesystem::path& path, std::string_view text);

}  // namespace asip::program
