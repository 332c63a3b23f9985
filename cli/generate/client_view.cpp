// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/client_view.hpp"

#include <fmt/format.h>

#include <limits>

#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"

namespace asip::generate {
namespace {

using model::EventShape;
using model::Field;
using model::ServiceModel;
using model::ValueType;
using nlohmann::json;

/// An item with its fields in order; null where it is text as on the wire, which no client sends.
json plain_item(const Field& list, const json& item) {
    if (list.items.size() == 1 && !item.is_structured()) return item;
    if (item.is_array()) return list.items.size() == 1 && item.size() == 1 ? item.front() : item;
    if (!item.is_object()) return nullptr;
    json values = json::array();
    for (const auto& field : list.items)
        if (const auto found = item.find(field.name); found != item.end()) values.push_back(*found);
    if (values.size() != item.size()) return nullptr;
    return list.items.size() == 1 ? values.front() : values;
}

/// Puts the items of lists into one form; false where one cannot be.
bool make_plain(const model::CommandModel& command, json& values) {
    const auto given = model::given_arguments(command);
    for (std::size_t i = 0; i < std::min(given.size(), values.size()); ++i) {
        if (given[i]->type != ValueType::kList) continue;
        if (!values[i].is_array()) return false;
        for (auto& item : values[i]) {
            item = plain_item(*given[i], item);
            if (item.is_null() || (given[i]->items.size() > 1 && item.size() != given[i]->items.size()))
                return false;
        }
    }
    return true;
}

}  // namespace

std::vector<ExampleCall> example_calls(const ServiceModel& model) {
    std::vector<ExampleCall> calls;
    for (const auto& example : model::examples(model)) {
        const auto document = model::parse_json(example.json);
        if (example.is_event() || !document || !document->is_object() || document->size() != 1) continue;
        const auto* command = model.command(document->begin().key());
        if (command == nullptr) continue;
        auto values = model::argument_values(*command, document->begin().value());
        if (!values || !make_plain(*command, *values)) continue;
        const bool complete = values->size() == model::given_arguments(*command).size();
        calls.push_back({command, std::move(*values), example.error, complete});
    }
    return calls;
}

std::vector<ExampleEvent> example_events(const ServiceModel& model) {
    std::vector<ExampleEvent> events;
    for (const auto& example : model::examples(model)) {
        const auto document = model::parse_json(example.json);
        if (!example.is_event() || !document || !document->is_object() || document->size() != 1) continue;
        if (const auto* event = model.event_named(document->begin().key()))
            events.push_back({event, document->begin().value()});
    }
    return events;
}

EventForm form_of(const model::EventModel& event) {
    switch (event.shape) {
        case EventShape::kPerElement:
            return event.fields.size() == 1 ? EventForm::kValues : EventForm::kObjects;
        case EventShape::kOnce:
            return EventForm::kObject;
        case EventShape::kPlain:
            return event.fields.size() == 1 ? EventForm::kValue : EventForm::kObject;
        case EventShape::kPortMap:
            return EventForm::kPorts;
        case EventShape::kMap:
        case EventShape::kPorts:
            break;
    }
    return EventForm::kByKey;
}

std::string without_guess(const std::string& error) {
    return error.substr(0, error.find("; did you mean"));
}

std::string plain_number(double number) {
    return fmt::format("{}", number);
}

Bounds bounds_of(const Field& field) {
    return {field.min.value_or(std::numeric_limits<std::int32_t>::min()),
            field.max.value_or(std::numeric_limits<std::int32_t>::max())};
}

}  // namespace asip::generate
