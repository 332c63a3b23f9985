// SPDX-License-Identifier: Apache-2.0
#include "asip/property/service_properties.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "asip/model/hints.hpp"

namespace asip::property {
namespace {

using model::CommandModel;
using model::EventModel;
using model::EventShape;
using model::Field;
using model::ValueType;

constexpr std::size_t kUsualTextBytes = 62;  // what fits into a line
constexpr double kLargestSmallRange = 16;    // of an element's number: then there are as many elements
constexpr int kMaxElements = 64;
constexpr const char* kLightName = "light";

/// Where a report has a field, of one element where it has several.
std::string pointer_of(const EventModel& event, const std::string& field, std::optional<int> element) {
    auto pointer = "/" + event.name;
    if (event.shape == EventShape::kPerElement) pointer += "/" + std::to_string(element.value_or(0));
    return event.shape == EventShape::kOnce || event.fields.size() > 1 ? pointer + "/" + field : pointer;
}

bool is_light(const Field& argument, const model::FieldHints& hints) {
    return hints.quantity == "brightness" || argument.type == ValueType::kColor;
}

class ServiceProperties {
  public:
    ServiceProperties(const model::Description& description, const model::ServiceInfo& service,
                      const model::ServiceModel& model)
        : description_(description), service_(service), model_(model), hints_(*model.hints) {
        find_undoing();
        count_names();
    }

    std::vector<Property> make() {
        for (const auto& command : model_.commands)
            add_command(command);
        std::vector<Property> settable = std::exchange(result_, {});
        for (auto& [element, light] : lights_)
            add(light, kLightName, kLightName, element);
        for (const auto& event : model_.events)
            add_event(event);
        result_.insert(result_.end(), settable.begin(), settable.end());
        add_stop();
        add_setters();
        name_all();
        return std::move(result_);
    }

  private:
    struct Part {
        std::string name;
        std::optional<int> element;
    };

    int elements(const Field* argument) const {
        int count = 1;
        if (service_.count) {
            count = *service_.count;
        } else if (hints_.elements()) {
            count = *hints_.elements();
        } else if (hints_.element_for_each_pin()) {
            count = static_cast<int>(
                std::count(description_.pins.owners.begin(), description_.pins.owners.end(), service_.id));
            count = std::max(count, 1);
        } else if (argument != nullptr && argument->min == 0 && argument->max &&
                   *argument->max < kLargestSmallRange) {
            count = static_cast<int>(*argument->max) + 1;
        }
        return std::min(count, kMaxElements);
    }

    bool is_element(const Field& argument) const {
        return !model_.element.empty() && argument.name == model_.element && is_number(argument);
    }

    const Field* element_argument(const CommandModel& command) const {
        for (const auto* argument : model::given_arguments(command))
            if (is_element(*argument)) return argument;
        return nullptr;
    }

    // --- names

    /// The argument that a property of this command would set; null, with `possible`: the command is a
    /// button.
    const Field* free_argument(const CommandModel& command, bool& possible) const {
        std::vector<const Field*> free;
        for (const auto* argument : model::given_arguments(command))
            if (!is_element(*argument) && !hints_.argument(command, argument->name).default_value)
                free.push_back(argument);
        possible = free.size() <= 1 && (free.empty() || free[0]->type != ValueType::kList);
        return possible && !free.empty() ? free[0] : nullptr;
    }

    /// How many properties of the model would have each name; it decides without the board.
    void count_names() {
        for (const auto& event : model_.events)
            for (const auto& field : event.fields)
                if (event.shape != EventShape::kMap) ++names_[field.name];
        for (const auto& command : model_.commands) {
            if (is_for_others(command)) continue;
            bool possible = false;
            const auto* argument = free_argument(command, possible);
            if (!possible) continue;
            if (argument == nullptr)
                ++names_[command.name];
            else if (!is_light(*argument, hints_.argument(command, argument->name)))
                ++names_[argument->name];
        }
        for (const auto& command : model_.commands)
            if (const auto shown = hints_.shown_by(command)) --names_[shown->field];
    }

    std::string unique(const std::string& owner, const std::string& name) const {
        const auto count = names_.find(name);
        return count != names_.end() && count->second > 1 ? owner + "." + name : name;
    }

    Property& add(Property property, const std::string& owner, const std::string& name,
                  std::optional<int> element) {
        property.service = service_.name;
        property.id = service_.name;
        if (!model_.element.empty() && element) property.id += "/" + std::to_string(*element);
        const auto last = owner == name ? name : unique(owner, name);
        if (last != model_.name) property.id += "/" + last;
        parts_[property.id] = {name, element};
        result_.push_back(std::move(property));
        return result_.back();
    }

    // --- what is read

    void add_field(const EventModel& event, const Field& field, std::optional<int> element) {
        const auto hints = hints_.field(event, field.name);
        Property property;
        property.read = Place{service_.name, pointer_of(event, field.name, element), hints.sum};
        property.advanced = hints.advanced;
        describe_number(property, field, hints);
        if (field.type == ValueType::kText) property.max_length = field.max_length.value_or(kUsualTextBytes);
        property.choices = two_values(field, hints);
        if (!property.choices.empty())
            property.kind = Kind::kBinarySensor;
        else if (names_say_all(field))
            property.choices = named_numbers(field);
        add(std::move(property), event.name, field.name, element);
    }

    void add_event(const EventModel& event) {
        for (const auto& field : event.fields) {
            if (shown_.contains({event.name, field.name})) continue;
            if (event.shape == EventShape::kPerElement) {
                const auto count = elements(nullptr);
                for (int element = 0; element < count; ++element)
                    add_field(event, field, element);
            } else if (event.shape == EventShape::kOnce || event.shape == EventShape::kPlain) {
                add_field(event, field, std::nullopt);
            }
        }
    }

    // --- what is set

    /// Reports are the business of the bus, and what is asked for is shown by its answer.
    bool is_for_others(const CommandModel& command) const {
        const auto given = model::given_arguments(command);
        const bool report = given.size() == 1 && given[0]->name == "period" && given[0]->unit == "ms";
        return report || command.answer != 0 || undoes_.contains(command.name) ||
               hints_.sets(command) != nullptr;
    }

    void add_command(const CommandModel& command) {
        if (is_for_others(command)) return;
        bool possible = false;
        const auto* argument = free_argument(command, possible);
        if (!possible) return;
        const auto* element = element_argument(command);
        const auto count = element != nullptr ? elements(element) : 1;
        for (int i = 0; i < count; ++i) {
            Call call{service_.name, command.name, {}};
            Setter setter{command.name, std::nullopt, i, std::nullopt};
            for (const auto* each : model::given_arguments(command)) {
                const auto at = call.arguments.size();
                if (each == element) {
                    setter.element_at = at;
                    call.arguments.emplace_back(i);
                } else if (each == argument) {
                    setter.value_at = at;
                    call.arguments.emplace_back();
                } else {
                    call.arguments.push_back(hints_.argument(command, each->name).default_value);
                }
            }
            add_call(command, argument, std::move(call), std::move(setter),
                     element != nullptr ? std::optional(i) : std::nullopt);
        }
    }

    void add_call(const CommandModel& command, const Field* argument, Call call, Setter setter,
                  std::optional<int> element) {
        Property property;
        property.advanced = hints_.advanced(command);
        if (argument == nullptr) {
            property.kind = Kind::kButton;
            property.write = std::move(call);
            add(std::move(property), command.name, command.name, element);
            return;
        }
        const auto hints = hints_.argument(command, argument->name);
        if (is_light(*argument, hints)) return add_to_light(*argument, hints, call, setter, element);
        property.write = std::move(call);
        property.setters.push_back(std::move(setter));
        if (argument->type == ValueType::kText) {
            property.kind = Kind::kText;
            property.max_length = argument->max_length.value_or(kUsualTextBytes);
        } else {
            describe_number(property, *argument, hints);
            make_settable(property, *argument, hints);
        }
        if (const auto shown = hints_.shown_by(command)) show_by(property, *shown, element);
        add(std::move(property), command.name, argument->name, element);
    }

    void add_to_light(const Field& argument, const model::FieldHints& hints, Call& call, Setter& setter,
                      std::optional<int> element) {
        auto& light = lights_[element];
        light.kind = Kind::kLight;
        const bool color = argument.type == ValueType::kColor;
        setter.color = color;
        light.setters.push_back(std::move(setter));
        (color ? light.color : light.write) = std::move(call);
        if (!color) describe_number(light, argument, hints);
    }

    void show_by(Property& property, const model::ModelHints::Shown& shown, std::optional<int> element) {
        const auto* event = model_.event_named(shown.event);
        if (event == nullptr) return;
        property.read = Place{service_.name, pointer_of(*event, shown.field, element)};
        shown_.insert({shown.event, shown.field});
    }

    // --- what else changes a value

    void find_undoing() {
        for (const auto& command : model_.commands)
            if (command.safe && command.safe->command != command.name) undoes_.insert(command.safe->command);
        if (const auto stop = stop_call(service_.name, model_); stop && stop->arguments.empty())
            undoes_.insert(stop->command);
    }

    /// For commands that set values of others by their model, and for those without arguments, behind which
    /// nothing that was set is known.
    void add_setters() {
        for (const auto& command : model_.commands) {
            if (command.answer != 0) continue;
            const auto* sets = hints_.sets(command);
            const bool forgets = sets == nullptr && model::given_arguments(command).empty();
            for (auto& property : result_) {
                if (property.setters.empty()) continue;
                const auto part = parts_.find(property.id);
                if (forgets && !(property.write && property.write->command == command.name))
                    property.setters.push_back({command.name, std::nullopt, 0, std::nullopt});
                if (sets != nullptr) add_set(property, part->second, command, *sets);
            }
        }
    }

    void add_set(Property& property, const Part& part, const CommandModel& command,
                 const std::vector<model::ModelHints::Sets>& sets) const {
        for (const auto& each : sets) {
            if (each.name != part.name) continue;
            if (each.element && each.element != part.element) continue;
            Setter setter{command.name, std::nullopt, part.element.value_or(0), std::nullopt, each.value};
            const auto given = model::given_arguments(command);
            for (std::size_t at = 0; at < given.size(); ++at) {
                if (!each.element && is_element(*given[at])) setter.element_at = at;
                if (!each.argument.empty() && given[at]->name == each.argument) setter.value_at = at;
            }
            property.setters.push_back(std::move(setter));
        }
    }

    void add_stop() {
        auto call = stop_call(service_.name, model_);
        if (!call) return;
        Property button;
        button.kind = Kind::kButton;
        button.write = std::move(call);
        button.advanced = std::none_of(result_.begin(), result_.end(), [](const Property& each) {
            return each.settable() && !each.advanced;
        });
        add(std::move(button), "stop", "stop", std::nullopt);
    }

    /// "Distance 1", "Left arm angle": what people call the service, the element where there are several, the
    /// field where that says more.
    void name_all() {
        const auto label = description_.labels.service(service_.name);
        std::map<std::optional<int>, int> in_element;
        std::set<int> numbers;
        for (const auto& [id, part] : parts_) {
            ++in_element[part.element];
            if (part.element) numbers.insert(*part.element);
        }
        for (auto& property : result_) {
            const auto& part = parts_[property.id];
            property.name = label.empty() ? capital(words_of(service_.name)) : label;
            if (part.element && numbers.size() > 1) property.name += " " + std::to_string(*part.element);
            const bool alone = in_element[part.element] == 1 && (part.element || parts_.size() == 1);
            if (part.name != model_.name && part.name != kLightName && (!alone || label.empty()))
                property.name += " " + words_of(part.name);
        }
    }

    const model::Description& description_;
    const model::ServiceInfo& service_;
    const model::ServiceModel& model_;
    const model::ModelHints& hints_;
    std::set<std::string> undoes_;
    std::map<std::string, int, std::less<>> names_;
    std::set<std::pair<std::string, std::string>> shown_;  // event and field: a property that is set shows it
    std::map<std::optional<int>, Property> lights_;
    std::map<std::string, Part> parts_;
    std::vector<Property> result_;
};

}  // namespace

std::vector<Property> service_properties(const model::Description& description,
                                         const model::ServiceInfo& service,
                                         const model::ServiceModel& model) {
    return ServiceProperties(description, service, model).make();
}

}  // namespace asip::property
