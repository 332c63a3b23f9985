// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string_view>

#include "sim/world/world.hpp"

namespace asip::sim::world {

/// Reads a world file (docs/robot.md). The error is one line: the file, the place in it and what is wrong.
Expected<std::shared_ptr<World>> load_world(const std::filesystem::path& file);
/// The same from text; `file` is only for the errors.
Expected<std::shared_ptr<World>> parse_world(std::string_view text, const std::filesystem::path& file);

}  // namespace asip::sim::world
