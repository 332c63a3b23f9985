// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "asip/model/description.hpp"
#include "gateway/export/entity.hpp"

namespace asip::gateway::exports {

/// The pins that no service owns and that are in use: those with a mode or a label. `io`: the service of the
/// pins. A pin without a label is hidden at first. A board with the label `kind=light` has lights at its PWM
/// pins.
std::vector<Entity> pin_entities(const model::Description& description, const model::ServiceInfo& io);

}  // namespace asip::gateway::exports
