// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/board_match.hpp"

#include <algorithm>

namespace asip::bus {
namespace {

unsigned capabilities_of(const model::Description& description) {
    unsigned all = 0;
    for (const char digit : description.pins.capabilities)
        if (digit >= '0' && digit <= '7') all |= static_cast<unsigned>(digit - '0');
    return all;
}

}  // namespace

bool service_matches(const Query& query, const ServiceItem& service, const model::Description* description,
                     const model::ModelSet& models) {
    return matches_service(query, service.name, service.kind, [&](const std::string& unit) {
        const auto* info = description == nullptr ? nullptr : description->service(service.name);
        const auto model = info == nullptr ? models.find(service.name) : model_of(*info, models);
        if (!model) return false;
        const auto units = model::units_of(*model);
        return std::find(units.begin(), units.end(), unit) != units.end();
    });
}

bool board_matches(const Query& query, const BoardItem& board, const model::Description* description,
                   const model::ModelSet& models) {
    const unsigned capabilities = description == nullptr ? 0 : capabilities_of(*description);
    if (!matches_board(
            query, {board.board, board.state, board.chip, board.sketch, capabilities, &board.labels.labels}))
        return false;
    if (!asks_for_services(query)) return true;
    return std::any_of(board.services.begin(), board.services.end(), [&](const ServiceItem& service) {
        return service_matches(query, service, description, models);
    });
}

model::ModelPtr model_of(const model::ServiceInfo& service, const model::ModelSet& models) {
    if (service.own_model) return service.own_model;
    if (!service.model.empty()) {
        if (auto exact = models.find_ref(service.model)) return exact;
        return models.find(service.model.substr(0, service.model.find('@')));
    }
    if (service.id == 0) return models.find(service.name);
    return nullptr;
}

}  // namespace asip::bus
