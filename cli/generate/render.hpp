// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace asip::generate {

/// Fills a Mustache template whose tags stand in `<% %>`; nothing is escaped. A line with only a section's
/// tag leaves no line; a missing name is empty. Throws std::logic_error on a broken template.
std::string render(std::string_view text, const nlohmann::json& view);

/// From templates/, without `.mustache`. Throws std::logic_error where there is none.
std::string_view template_text(std::string_view name);

}  // namespace asip::generate
