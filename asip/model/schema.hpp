// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "asip/expected.hpp"

namespace asip::model {

/// services/schema.json, built into the program. Parsed at the first call.
const nlohmann::json& service_model_schema();

/// Checks a document against the part of JSON Schema that our schema uses: type, properties,
/// patternProperties, required, additionalProperties, enum, const, pattern, items, minItems, maxItems,
/// minLength, maxLength, minimum, maximum, minProperties, maxProperties, propertyNames, anyOf and $ref into
/// `definitions`. Fails with the first fault as "/place: reason", the place being a JSON pointer. A keyword
/// that is not listed is a fault of the schema and reported as such.
Expected<void> check_schema(const nlohmann::json& schema, const nlohmann::json& document);

}  // namespace asip::model
