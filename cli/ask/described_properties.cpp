// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/described_properties.hpp"

#include "asip/bus/registry/board_match.hpp"
#include "asip/property/list.hpp"

namespace asip::cli {

const std::vector<property::Property> DescribedProperties::kNone;

const std::vector<property::Property>& DescribedProperties::of(const std::string& board) {
    const auto [known, is_new] = known_.try_emplace(board);
    if (is_new) session_.caller().watch_description(board);
    const auto* description = session_.boards().description(board);
    if (description == nullptr) return kNone;
    const std::pair by(description->session, description->seq);
    if (known->second.by != by) {
        known->second = {by, property::properties_of(*description, [this](const model::ServiceInfo& service) {
                             return bus::model_of(service, environment_.models());
                         })};
    }
    return known->second.properties;
}

}  // namespace asip::cli
