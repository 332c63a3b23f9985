// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"
#include "asip/property/property.hpp"

namespace asip::property {

/// Those of one service that has a model; the pins of the I/O service are elsewhere.
std::vector<Property> service_properties(const model::Description& description,
                                         const model::ServiceInfo& service, const model::ServiceModel& model);
/// Those of the pins, by their meanings and by the modes that commands set.
std::vector<Property> pin_properties(const model::Description& description, const model::ServiceInfo& io);

}  // namespace asip::property
