// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <vector>

#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"
#include "asip/property/property.hpp"

namespace asip::property {

/// The model of a service; null: none is known, and the service has no properties.
using FindModel = std::function<model::ModelPtr(const model::ServiceInfo&)>;

/// All that a board shows and lets be set, in the order of its services, pins last. The same description
/// gives the same list, and the id of a property depends on its model alone. What the models lack costs the
/// properties something, never the list.
std::vector<Property> properties_of(const model::Description& description, const FindModel& find_model);

}  // namespace asip::property
