// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asip/links/link.hpp"
#include "cli/ask/retained.hpp"

namespace asip::cli {

/// A link that an agent shows.
struct ShownLink {
    std::string board;
    links::Link link;
    nlohmann::json object;  ///< with what it did last
    std::string id() const { return board + "/" + link.name; }
};

/// All links in these messages; what cannot be read is passed over.
std::vector<ShownLink> read_links(const bus::Topics& topics, const std::vector<Retained>& retained);

}  // namespace asip::cli
