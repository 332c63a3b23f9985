// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"

namespace asip::gateway::exports {

/// A board with every standard service and pins in each mode.
inline model::Description description_of_all() {
    model::Description description;
    description.board = "uno1";
    for (const auto& model : model::ModelSet::standard().all()) {
        model::ServiceInfo info;
        info.name = model->name;
        info.id = model->id;
        description.services.push_back(info);
    }
    description.pins.capabilities = "1111111111111111";
    description.pins.owners = "------------------";
    description.pins.modes = "000000000000000000";
    description.pins.analog = {{14, 0}};
    description.labels.modes = {{2, 1}, {3, 2}, {4, 3}, {5, 5}, {14, 4}};
    return description;
}

}  // namespace asip::gateway::exports
