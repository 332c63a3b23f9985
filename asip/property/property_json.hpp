// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "asip/property/property.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::property {

inline constexpr std::size_t kMaxWordBytes = 256;  ///< of any text in a document

enum class Members {
    kNeeded,  ///< on the bus: without those that a reader derives from others
    kAll      ///< over HTTP, for people and small programs
};

nlohmann::json to_json(const Property& property, Members members);
/// From either form.
Property read_property(text::JsonReader& reader);

}  // namespace asip::property
