// SPDX-License-Identifier: Apache-2.0
// What an export says of the gateway itself.
#include <algorithm>
#include <utility>

#include "gateway/export/exporter.hpp"

namespace asip::gateway::exports {

/// Its document, and that it exports.
void Exporter::show_gateway() {
    gateway_due_ = false;
    if (const auto topic = dialect().gateway_document_topic(); !topic.empty()) {
        std::vector<std::string> boards;
        for (const auto& [name, record] : records_)
            boards.push_back(name);
        std::sort(boards.begin(), boards.end());
        auto document = dialect().gateway_document(boards, gateway_document_);
        if (document != gateway_document_) {
            if (!dialect().changing().empty()) retain(dialect().gateway_state(), dialect().changing());
            retain(topic, document);
            gateway_document_ = std::move(document);
        }
    }
    retain(dialect().gateway_state(), dialect().online());
}

/// Once every board was looked at.
void Exporter::show_standing() {
    const auto topic = dialect().standing_topic();
    if (phase_ != Phase::kActive || topic.empty() || !dirty_.empty() || !port_.has_room()) return;
    auto standing = dialect().standing(online_);
    if (standing == standing_) return;
    retain(topic, standing);
    standing_ = std::move(standing);
}

}  // namespace asip::gateway::exports
