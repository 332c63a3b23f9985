// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::generate {

/// What the templates of a sketch are filled with. `model` has no firmware_fault(). Fails with two names of
/// it that become one in C++.
Expected<nlohmann::json> sketch_view(const model::ServiceModel& model, const std::string& sketch,
                                     std::size_t elements);

}  // namespace asip::generate
