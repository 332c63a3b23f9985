// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "asip/model/service_model.hpp"
#include "asip/property/property.hpp"

namespace asip::cli {

/// A value of an event, with what the model knows.
struct LeafValue {
    std::string path;  ///< below the event: `0`, `1.count`; empty where the event is one value
    nlohmann::json value;
    std::string unit;     ///< empty: none
    std::string words{};  ///< of the property whose value it is: `pressed`; empty: it is of none

    std::string text() const;  ///< the words, else `42 cm`
};

/// In order; null: the board has no value. `value`: below the event's name.
std::vector<LeafValue> leaf_values(const model::ServiceModel& model, const model::EventModel& event,
                                   const nlohmann::json& value);

/// Gives those that are values of properties the words of these, which every program shows to people.
void say_as_properties(std::vector<LeafValue>& leaves, const std::string& service, const std::string& event,
                       const std::vector<property::Property>& properties);

/// Which part of a service's events FIELD means: the name of an event, or of a field of one, and a path below
/// it.
struct FieldChoice {
    const model::EventModel* event = nullptr;
    std::string path;  ///< below the event's value; empty: all of it

    bool takes(std::string_view leaf_path) const;
};

/// `distance`, `distance/0`, `0` or `pulse`; empty: the first event. Fails with what there is, and the
/// nearest.
Expected<FieldChoice> choose_field(const model::ServiceModel& model, std::string_view field);

/// Without arguments; may be null.
const model::CommandModel* asking_command(const model::ServiceModel& model, const model::EventModel& event);

}  // namespace asip::cli
