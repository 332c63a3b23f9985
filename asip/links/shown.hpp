// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "asip/links/link.hpp"

namespace asip::links {

/// A link as its agent shows it on `$links`.
struct ShownLink {
    std::string board;  ///< of the target
    Link link;
    nlohmann::json object;  ///< as shown, with `board`, and in words `rule` and `state`
    std::string id() const { return board + "/" + link.name; }
};

/// The links of a board; what cannot be read is passed over.
std::vector<ShownLink> read_shown(std::string_view board, std::string_view document);

}  // namespace asip::links
