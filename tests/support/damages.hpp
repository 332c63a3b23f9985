// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <string_view>

namespace wire {

/// Each single damage of `line`: a byte changed, left out, doubled, or another one in front of it. `bytes`:
/// those that come into it. `tried` is false where it has seen enough.
bool each_damage(std::string_view line, std::string_view bytes,
                 const std::function<bool(const std::string&)>& tried);

/// Bytes that print nothing as `\x00`.
std::string visible(std::string_view bytes);

}  // namespace wire
