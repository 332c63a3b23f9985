// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/environment.hpp"

namespace asip::cli {

struct ModelOptions {
    std::string action;              ///< of kModelActions
    std::vector<std::string> files;  ///< one; for a sketch, services
    std::string output;
    std::string image;
    std::optional<std::size_t> elements;
    bool force = false;
};

inline constexpr std::array<std::string_view, 6> kModelActions{"check", "firmware", "part",
                                                               "cpp",   "docs",     "sketch"};

/// Checks the model in a file, or makes something of it; or makes a sketch of services.
int make_of_model(const ModelOptions& options, Environment& environment);

}  // namespace asip::cli
