// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "cli/environment.hpp"

namespace asip::cli {

struct ModelOptions {
    std::string action;  ///< of kModelActions
    std::string file;
    std::string output;
    std::string image;
    std::optional<std::size_t> elements;
    bool force = false;
};

inline constexpr std::array<std::string_view, 5> kModelActions{"check", "firmware", "part", "cpp", "docs"};

/// Checks the model in a file, or makes something of it.
int make_of_model(const ModelOptions& options, Environment& environment);

}  // namespace asip::cli
