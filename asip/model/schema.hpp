// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "asip/expected.hpp"

namespace asip::model {

/// services/schema.json. Parsed at the first call.
const nlohmann::json& service_model_schema();

/// Checks a document against the keywords of JSON Schema that our schema uses. Fails with the first fault,
/// "/place: reason", the place being a JSON pointer; an unknown keyword is a fault.
Expected<void> check_schema(const nlohmann::json& schema, const nlohmann::json& document);

}  // namespace asip::model
