// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace asip::generate {

/// Fills a Mustache template with the members of an object. Its tags stand in `<% %>`, so that braces are
/// those of the code; nothing is escaped. A line with nothing but the tag of a section leaves no line. A name
/// that the view does not have is empty. Throws std::logic_error for a template that is broken, as it is
/// ours.
std::string render(std::string_view text, const nlohmann::json& view);

/// A file of templates/, by its name without `.mustache`: "service.cpp". Throws std::logic_error where there
/// is none.
std::string_view template_text(std::string_view name);

}  // namespace asip::generate
