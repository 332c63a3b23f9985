// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/shown_links.hpp"

#include "asip/model/json.hpp"

namespace asip::cli {

using nlohmann::json;

std::vector<ShownLink> read_links(const bus::Topics& topics, const std::vector<Retained>& retained) {
    std::vector<ShownLink> result;
    for (const auto& message : retained) {
        const auto topic = topics.parse(message.topic);
        const auto document =
            model::parse_json(message.payload, {.max_bytes = std::size_t{1} << 20, .max_depth = 16});
        if (!topic || topic->kind != bus::TopicKind::kLinks || !document || !document->is_object()) continue;
        for (const auto& object : document->value("links", json::array())) {
            auto bare = object;
            for (const auto* shown : {"suspended", "last", "at", "fault"})
                if (bare.is_object()) bare.erase(shown);
            if (auto link = links::read_link(bare))
                result.push_back({std::string(topic->board), std::move(*link), object});
        }
    }
    return result;
}

}  // namespace asip::cli
