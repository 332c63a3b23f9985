// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string_view>
#include <vector>

#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"
#include "gateway/export/entity.hpp"

namespace asip::gateway::exports {

inline constexpr std::size_t kMaxEntities = 256;  ///< of a board
inline constexpr int kMaxElements = 64;           ///< of a service

/// The model of a service; null: none is known, and the service has no entities.
using FindModel = std::function<model::ModelPtr(const model::ServiceInfo&)>;

/// All that a board shows and lets be set, in the order of its services, pins last. The same description
/// gives the same entities. What the models lack costs their entities something, never the entities.
std::vector<Entity> entities_of(const model::Description& description, const FindModel& find_model);

/// "Left Arm #2" -> "left-arm-2": `a-z0-9-`, with no dash at an end; "x" where nothing is left.
std::string slug_of(std::string_view text);

}  // namespace asip::gateway::exports
