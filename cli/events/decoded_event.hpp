// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cli/events/context_event.hpp"
#include "cli/events/leaf_values.hpp"

namespace asip::cli {

/// By its model: units for people, one part for programs. Pure.
struct DecodedEvent {
    std::string field;              ///< of the selection: `distance/0`; empty where nothing was selected
    std::vector<LeafValue> leaves;  ///< the selection
    std::string text;   ///< for people: `distance 42 cm, 118 cm`; the payload where no model is known
    std::string what;   ///< which kind of report it is: two with one text are about the same
    std::string value;  ///< what is compared to see whether it changed
};

/// `model` may be null: then `field` is a path into the payload (`tag`, `a/0`). Nothing where `field` is
/// given and the report does not have it. Errors and raw lines are taken as they are. `properties`: of the
/// board, whose words are used; empty where its description is not known.
std::optional<DecodedEvent> decode_event(const ContextEvent& event, const model::ServiceModel* model,
                                         const std::vector<property::Property>& properties,
                                         const std::string& field);

/// `42 cm` of one, `0.pulse=3000 us 0.count=11` of several.
std::string leaves_text(const std::vector<LeafValue>& leaves);

}  // namespace asip::cli
