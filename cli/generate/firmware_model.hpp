// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/model/service_model.hpp"

/// What of a service model firmware is made of.
namespace asip::generate {

/// Whether its body is a list of values in braces.
bool is_list(const model::EventModel& event);
/// The event that goes out periodically; null where the service has none.
const model::EventModel* reported_event(const model::ServiceModel& model);
/// Why no firmware can be made, with the place; empty where it can.
std::string firmware_fault(const model::ServiceModel& model);

}  // namespace asip::generate
