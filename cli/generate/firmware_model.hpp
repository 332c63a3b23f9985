// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/model/service_model.hpp"

/// What of a service model firmware is made of.
namespace asip::generate {

/// Its body is a list of values in braces.
bool is_list(const model::EventModel& event);
/// The one that goes out periodically; may be null.
const model::EventModel* reported_event(const model::ServiceModel& model);
/// Why no firmware can be made, with the place; empty: it can.
std::string firmware_fault(const model::ServiceModel& model);

}  // namespace asip::generate
