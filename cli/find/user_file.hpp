// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "asip/expected.hpp"

namespace asip::cli {

using Variables = std::function<std::optional<std::string>(const std::string&)>;

/// Where a user keeps options of asipctl, which name a bus: `$XDG_CONFIG_HOME/asip/asipctl.conf`, else
/// `~/.config/asip/asipctl.conf`. Nothing: neither variable is set.
std::optional<std::filesystem::path> user_file(const Variables& variables);

/// Puts the lines of that file in front, as options. A user who names a broker, credentials or a
/// configuration file otherwise uses none of it: a password goes to no other broker. Fails on a file that
/// cannot be read.
Expected<std::vector<std::string>> with_user_file(std::vector<std::string> arguments,
                                                  const Variables& variables);

}  // namespace asip::cli
