// SPDX-License-Identifier: Apache-2.0
#include "asip/links/shown.hpp"

#include "asip/model/json.hpp"

namespace asip::links {

using nlohmann::json;

std::vector<ShownLink> read_shown(std::string_view board, std::string_view document) {
    std::vector<ShownLink> result;
    const auto read = model::parse_json(document, {.max_bytes = std::size_t{1} << 20, .max_depth = 16});
    if (!read || !read->is_object() || !read->contains("links")) return result;
    for (auto object : (*read)["links"]) {
        if (!object.is_object()) continue;
        auto bare = object;
        for (const auto* shown : {"suspended", "last", "at", "fault"})
            bare.erase(shown);
        auto link = read_link(bare);
        if (!link) continue;
        const auto fault = object.find("fault");
        object["board"] = board;
        object["rule"] = in_words(*link);
        object["state"] = !link->enabled                                ? json("disabled")
                          : fault != object.end() && fault->is_string() ? *fault
                          : object.contains("suspended")                ? json("until the source changes")
                                                                        : json("on");
        result.push_back({std::string(board), std::move(*link), std::move(object)});
    }
    return result;
}

}  // namespace asip::links
