// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asip/model/service_model.hpp"

namespace asip::generate {

/// A command as a call: a value for each given argument, items with several fields as arrays.
struct ExampleCall {
    const model::CommandModel* command = nullptr;
    nlohmann::json values;
    std::string error;      ///< why it is refused; empty: it is not
    bool complete = false;  ///< there is a value for each argument, and no more
};
/// Without commands or arguments that the model lacks.
std::vector<ExampleCall> example_calls(const model::ServiceModel& model);

/// What the one member of an event carries.
struct ExampleEvent {
    const model::EventModel* event = nullptr;
    nlohmann::json value;
};
std::vector<ExampleEvent> example_events(const model::ServiceModel& model);

/// For a typed client.
enum class EventForm {
    kValue,    ///< one value
    kValues,   ///< one for each element
    kObject,   ///< its fields, of which the last may be missing
    kObjects,  ///< its fields for each element
    kByKey,    ///< numbers by pin or channel
    kPorts,    ///< port and mask of each pin
};
EventForm form_of(const model::EventModel& event);

/// A refusal as a client knows it: without a guess of what was meant.
std::string without_guess(const std::string& error);

/// "65535", "0.5".
std::string plain_number(double number);

/// 32 bits where the model has none.
struct Bounds {
    double low, high;
};
Bounds bounds_of(const model::Field& field);

}  // namespace asip::generate
