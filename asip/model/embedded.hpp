// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string_view>
#include <utility>

namespace asip::model {

// What the build made of services/: file texts with static storage.

std::string_view embedded_schema();
/// Name and text, sorted by name.
std::span<const std::pair<std::string_view, std::string_view>> embedded_models();

}  // namespace asip::model
