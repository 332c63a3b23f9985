// SPDX-License-Identifier: Apache-2.0
#include "cli/events/leaf_values.hpp"

#include <algorithm>

#include "asip/model/hints.hpp"
#include "asip/model/json.hpp"
#include "asip/property/value.hpp"
#include "asip/property/words.hpp"
#include "asip/text/nearest.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

const model::Field* field_of(const model::EventModel& event, const std::string& key) {
    for (const auto& field : event.fields)
        if (field.name == key) return &field;
    return event.fields.size() == 1 ? &event.fields.front() : nullptr;
}

LeafValue leaf_of(const model::ServiceModel& model, const model::EventModel& event,
                  const nlohmann::json& value, const std::string& path, const std::string& key) {
    const auto* field = field_of(event, key);
    if (field == nullptr) return {path, value, {}};
    const auto none = model.hints ? model.hints->field(event, field->name).none : std::nullopt;
    if (none && value.is_number() && value.get<double>() == *none) return {path, nullptr, {}};
    return {path, value, field->unit};
}

void collect(const model::ServiceModel& model, const model::EventModel& event, const nlohmann::json& value,
             const std::string& path, const std::string& key, std::vector<LeafValue>& leaves) {
    const auto below = [&path](const std::string& name) { return path.empty() ? name : path + "." + name; };
    if (value.is_object())
        for (const auto& [name, member] : value.items())
            collect(model, event, member, below(name), name, leaves);
    else if (value.is_array())
        for (std::size_t i = 0; i < value.size(); ++i)
            collect(model, event, value[i], below(std::to_string(i)), key, leaves);
    else
        leaves.push_back(leaf_of(model, event, value, path, key));
}

bool is_index(std::string_view text) {
    return !text.empty() &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

const model::EventModel* event_with_field(const model::ServiceModel& model, std::string_view name) {
    for (const auto& event : model.events) {
        for (const auto& field : event.fields)
            if (field.name == name) return &event;
    }
    return nullptr;
}

std::vector<std::string> names_of(const model::ServiceModel& model) {
    std::vector<std::string> names;
    for (const auto& event : model.events) {
        names.push_back(event.name);
        for (const auto& field : event.fields)
            if (field.name != event.name) names.push_back(field.name);
    }
    return names;
}

}  // namespace

std::string LeafValue::text() const {
    if (!words.empty()) return words;
    if (value.is_null()) return "none";
    const auto shown = value.is_string() ? value.get<std::string>() : model::dump_json(value);
    return unit.empty() ? shown : shown + " " + unit;
}

std::vector<LeafValue> leaf_values(const model::ServiceModel& model, const model::EventModel& event,
                                   const nlohmann::json& value) {
    std::vector<LeafValue> leaves;
    collect(model, event, value, {}, {}, leaves);
    return leaves;
}

void say_as_properties(std::vector<LeafValue>& leaves, const std::string& service, const std::string& event,
                       const std::vector<property::Property>& properties) {
    for (auto& leaf : leaves) {
        auto pointer = "/" + event + (leaf.path.empty() ? "" : "/" + leaf.path);
        std::replace(pointer.begin(), pointer.end(), '.', '/');
        for (const auto& property : properties) {
            if (!property.read || property.read->service != service || property.read->pointer != pointer)
                continue;
            // A sum, or a level that nothing holds, is more than one report says.
            if (property.read->sum || property.floating || property.kind == property::Kind::kLight) continue;
            if (const auto value = property::value_of(property, leaf.value))
                leaf.words = property::value_text(property, *value);
            break;
        }
    }
}

bool FieldChoice::takes(std::string_view leaf_path) const {
    if (path.empty() || leaf_path == path) return true;
    if (leaf_path.starts_with(path + ".")) return true;
    // A field of each element: `pulse` is `0.pulse`, `1.pulse`, ...
    return leaf_path.ends_with("." + path);
}

Expected<FieldChoice> choose_field(const model::ServiceModel& model, std::string_view field) {
    if (model.events.empty()) return fail("the model " + model.ref() + " has no events");
    if (field.empty()) return FieldChoice{&model.events.front(), {}};
    std::string path(field);
    std::replace(path.begin(), path.end(), '/', '.');
    const auto first = path.substr(0, path.find('.'));
    const auto rest = path.size() > first.size() ? path.substr(first.size() + 1) : std::string();
    if (const auto* event = model.event_named(first)) return FieldChoice{event, rest};
    if (is_index(first)) return FieldChoice{&model.events.front(), path};
    if (const auto* event = event_with_field(model, first)) return FieldChoice{event, path};
    const auto names = names_of(model);
    return fail("there is no field \"" + first + "\"" + text::did_you_mean(first, names) + "; there are " +
                listed(names));
}

const model::CommandModel* asking_command(const model::ServiceModel& model, const model::EventModel& event) {
    for (const auto& command : model.commands)
        if (command.answer == event.tag && command.args.empty()) return &command;
    return nullptr;
}

}  // namespace asip::cli
