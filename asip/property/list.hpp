// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <vector>

#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"
#include "asip/property/property.hpp"

namespace asip::property {

/// Null: none is known, and the service has no properties.
using FindModel = std::function<model::ModelPtr(const model::ServiceInfo&)>;

/// In the order of services, pins last. The same description gives the same list, and an id depends on its
/// model alone. Gaps in models cost properties something, never the list.
std::vector<Property> properties_of(const model::Description& description, const FindModel& find_model);

}  // namespace asip::property
