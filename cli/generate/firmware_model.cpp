// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/firmware_model.hpp"

#include <fmt/format.h>

#include <limits>

#include "asip/model/command_encoder.hpp"
#include "cli/generate/layout.hpp"
#include "cli/generate/names.hpp"

namespace asip::generate {

using model::CommandModel;
using model::EventModel;
using model::EventShape;
using model::Field;
using model::ServiceModel;
using model::ValueType;

bool is_list(const EventModel& event) {
    return event.shape == EventShape::kPerElement || event.shape == EventShape::kOnce;
}

const EventModel* reported_event(const ServiceModel& model) {
    if (model.events.empty() || model.command_with_tag('A') == nullptr) return nullptr;
    const auto* usual = model.event('e');
    return usual != nullptr ? usual : &model.events.front();
}

namespace {

bool is_period(const CommandModel& command) {
    return command.tag == 'A' && command.args.size() == 1 && command.args.front().type == ValueType::kInteger;
}

const char* shape_name(EventShape shape) {
    return shape == EventShape::kMap ? "map" : shape == EventShape::kPorts ? "ports" : "port-map";
}

std::string whole_fault(const Field& field) {
    if (field.type != ValueType::kInteger && field.type != ValueType::kColor) return {};
    const auto range = whole_range(field);
    if (range.low > range.high) return "there is no whole number from its min to its max";
    if (!range.fits(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()))
        return "its numbers do not fit 32 bits; give it a smaller min and max";
    return {};
}

std::string event_fault(const EventModel& event) {
    if (!is_list(event) && event.shape != EventShape::kPlain)
        return fmt::format(
            "the shape \"{}\" is that of the pins, which each board brings already; use a list",
            shape_name(event.shape));
    for (const auto& field : event.fields)
        if (auto fault = whole_fault(field); !fault.empty()) return field.name + ": " + fault;
    return {};
}

std::string command_fault(const ServiceModel& model, const CommandModel& command) {
    if (command.tag == 'A' && reported_event(model) != nullptr && !is_period(command))
        return "tag A sets the period of reports in each service that has events: its one argument is an "
               "integer; use another tag";
    if (model.command_with_tag(command.tag) != &command)
        return fmt::format("{} has the tag {} already; a board could not tell them apart",
                           model.command_with_tag(command.tag)->name, command.tag);
    for (const auto& argument : command.args) {
        if (auto fault = whole_fault(argument); !fault.empty()) return argument.name + ": " + fault;
        for (const auto& item : argument.items) {
            if (item.type == ValueType::kText || item.type == ValueType::kNumber)
                return fmt::format("{}: items of a list that are {} are not supported; use whole numbers",
                                   argument.name, to_text(item.type));
            if (auto fault = whole_fault(item); !fault.empty()) return item.name + ": " + fault;
        }
    }
    return {};
}

}  // namespace

std::string firmware_fault(const ServiceModel& model) {
    if (model.id == 'I')
        return "/id: I is the letter of the pins, which each board brings already; use another";
    for (const auto& event : model.events)
        if (auto fault = event_fault(event); !fault.empty())
            return fmt::format("/events/{}: {}", event.tag, fault);
    for (const auto& command : model.commands)
        if (auto fault = command_fault(model, command); !fault.empty())
            return fmt::format("/commands/{}: {}", command.name, fault);
    return {};
}

}  // namespace asip::generate
