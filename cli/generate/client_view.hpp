// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asip/model/service_model.hpp"

namespace asip::generate {

/// An example of a command as a call of a client: a value for each argument that is given, items of lists
/// with several fields as arrays.
struct ExampleCall {
    const model::CommandModel* command = nullptr;
    nlohmann::json values;
    std::string error;      ///< why it is refused; empty: it is not
    bool complete = false;  ///< there is a value for each argument, and no more
};
/// Those of the examples that are calls: a command or an argument that the model does not have is none.
std::vector<ExampleCall> example_calls(const model::ServiceModel& model);

/// An example of an event: what its one member carries.
struct ExampleEvent {
    const model::EventModel* event = nullptr;
    nlohmann::json value;
};
std::vector<ExampleEvent> example_events(const model::ServiceModel& model);

/// What an event carries, for a typed client.
enum class EventForm {
    kValue,    ///< one value
    kValues,   ///< one for each element
    kObject,   ///< its fields, of which the last may be missing
    kObjects,  ///< its fields for each element
    kByKey,    ///< numbers by pin or channel
    kPorts,    ///< port and mask of each pin
};
EventForm form_of(const model::EventModel& event);

/// The reason of a refusal as far as a client of its own knows it: no guess of what was meant.
std::string without_guess(const std::string& error);

/// A number as it stands in code and in messages: "65535", "0.5".
std::string plain_number(double number);

/// The bounds of a number that is an argument; 32 bits where the model has none.
struct Bounds {
    double low, high;
};
Bounds bounds_of(const model::Field& field);

}  // namespace asip::generate
