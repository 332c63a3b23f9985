// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::generate {

/// For the templates of a sketch. `model` has no firmware_fault(). Fails where two names become one.
Expected<nlohmann::json> sketch_view(const model::ServiceModel& model, const std::string& sketch,
                                     std::size_t elements);

}  // namespace asip::generate
