// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/entities.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <set>

#include "asip/model/hints.hpp"
#include "gateway/export/pin_entities.hpp"

namespace asip::gateway::exports {
namespace {

using model::CommandModel;
using model::EventModel;
using model::EventShape;
using model::Field;
using model::FieldHints;
using model::ValueType;

constexpr std::size_t kUsualTextBytes = 62;  // what fits into a line
constexpr std::size_t kMaxKnownHints = 256;
constexpr double kLargestSmallRange = 16;  // of an element's number: then there are as many elements

/// "stop-all" -> "stop all"
std::string words_of(std::string_view name) {
    std::string text(name);
    std::replace_if(text.begin(), text.end(), [](char c) { return c == '-' || c == '_' || c == '.'; }, ' ');
    return text;
}

std::string capital(std::string text) {
    if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

bool is_number(const Field& field) {
    return field.type == ValueType::kInteger || field.type == ValueType::kNumber;
}

/// The different numbers of a field's names, each with the first of its words.
std::vector<std::pair<std::string, double>> named_numbers(const Field& field) {
    std::vector<std::pair<std::string, double>> result;
    for (const auto& [word, value] : field.names) {
        const auto number = static_cast<double>(value);
        const bool there = std::any_of(result.begin(), result.end(),
                                       [&](const auto& each) { return each.second == number; });
        if (!there) result.emplace_back(word, number);
    }
    return result;
}

/// {"off", N}, {"on", M} of a field that has two values; empty: it has others.
std::vector<std::pair<std::string, double>> two_values(const Field& field, const FieldHints& hints) {
    std::vector<double> values;
    for (const auto& [word, value] : named_numbers(field))
        values.push_back(value);
    if (values.empty() && field.type == ValueType::kInteger && field.min && field.max &&
        *field.max == *field.min + 1)
        values = {*field.min, *field.max};
    if (values.size() != 2) return {};
    double on = std::max(values[0], values[1]);
    for (const auto& [word, value] : field.names)
        if (word == "on") on = static_cast<double>(value);
    if (hints.on &&
        (static_cast<double>(*hints.on) == values[0] || static_cast<double>(*hints.on) == values[1]))
        on = static_cast<double>(*hints.on);
    return {{"off", values[0] == on ? values[1] : values[0]}, {"on", on}};
}

/// Whether its words are all that a field can be.
bool names_say_all(const Field& field) {
    const auto count = static_cast<double>(named_numbers(field).size());
    if (count < 2) return false;
    return !field.min || !field.max || *field.max - *field.min + 1 == count;
}

void describe_number(Entity& entity, const Field& field, const FieldHints& hints) {
    entity.unit = field.unit;
    entity.quantity = hints.quantity;
    entity.whole = field.type == ValueType::kInteger;
    entity.min = field.min;
    entity.max = field.max;
    entity.step = hints.step;
}

/// Reading the hints of a model costs more than all that follows: boards that share one share them.
std::shared_ptr<const model::ModelHints> hints_of(const model::ModelPtr& model) {
    struct Known {
        std::weak_ptr<const model::ServiceModel> model;
        std::shared_ptr<const model::ModelHints> hints;
    };
    thread_local std::map<const model::ServiceModel*, Known> known;
    if (const auto found = known.find(model.get());
        found != known.end() && found->second.model.lock() == model)
        return found->second.hints;
    if (known.size() >= kMaxKnownHints) known.clear();
    auto hints = std::make_shared<const model::ModelHints>(*model);
    known[model.get()] = {model, hints};
    return hints;
}

/// The entities of one service.
class ServiceEntities {
  public:
    ServiceEntities(const model::Description& description, const model::ServiceInfo& service,
                    const model::ModelPtr& model)
        : description_(description), service_(service), model_(*model), shared_hints_(hints_of(model)) {}

    std::vector<Entity> make() {
        for (const auto& command : model_.commands)
            add_command(command);
        std::vector<Entity> settable = std::exchange(result_, {});
        add_lights();
        for (const auto& event : model_.events)
            add_event(event);
        result_.insert(result_.end(), settable.begin(), settable.end());
        add_stop();
        name_all();
        return std::move(result_);
    }

  private:
    struct Part {
        std::string id, field;
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

    const Field* element_argument(const CommandModel& command) const {
        for (const auto* argument : model::given_arguments(command))
            if (!model_.element.empty() && argument->name == model_.element && is_number(*argument))
                return argument;
        return nullptr;
    }

    Entity& add(Entity entity, std::string field, std::optional<int> element) {
        entity.id = slug_of(service_.name);
        if (element) entity.id += "-" + std::to_string(*element);
        if (slug_of(field) != slug_of(service_.name) && !field.empty()) entity.id += "-" + slug_of(field);
        parts_[entity.id] = {entity.id, std::move(field), element};
        result_.push_back(std::move(entity));
        return result_.back();
    }

    void add_field(const EventModel& event, const Field& field, const std::string& pointer,
                   std::optional<int> element) {
        const auto hints = hints_.field(event, field.name);
        Entity entity;
        entity.read = ValuePlace{service_.name, pointer};
        entity.default_on = !hints.advanced;
        describe_number(entity, field, hints);
        if (field.type == ValueType::kText) entity.max_length = field.max_length.value_or(kUsualTextBytes);
        entity.options = two_values(field, hints);
        if (!entity.options.empty()) {
            entity.kind = EntityKind::kBinarySensor;
        } else if (names_say_all(field)) {
            entity.options = named_numbers(field);
        }
        add(std::move(entity), field.name, element);
    }

    void add_event(const EventModel& event) {
        for (const auto& field : event.fields) {
            if (shown_.contains({event.name, field.name})) continue;
            const auto root = "/" + event.name;
            if (event.shape == EventShape::kPerElement) {
                const auto count = elements(nullptr);
                for (int element = 0; element < count; ++element)
                    add_field(event, field,
                              root + "/" + std::to_string(element) +
                                  (event.fields.size() > 1 ? "/" + field.name : std::string()),
                              element);
            } else if (event.shape == EventShape::kOnce ||
                       (event.shape == EventShape::kPlain && event.fields.size() > 1)) {
                add_field(event, field, root + "/" + field.name, std::nullopt);
            } else if (event.shape == EventShape::kPlain) {
                add_field(event, field, root, std::nullopt);
            }
        }
    }

    /// Reports are the business of the bus, and what is asked for is shown by its answer.
    bool is_for_others(const CommandModel& command) const {
        const auto given = model::given_arguments(command);
        const bool report = given.size() == 1 && given[0]->name == "period" && given[0]->unit == "ms";
        return report || command.answer != 0 || undoes_.contains(command.name);
    }

    void add_command(const CommandModel& command) {
        if (undoes_.empty()) find_undoing();
        if (is_for_others(command)) return;
        const auto* element = element_argument(command);
        std::vector<const Field*> free, with_default;
        for (const auto* argument : model::given_arguments(command)) {
            if (argument == element) continue;
            (hints_.argument(command, argument->name).default_value ? with_default : free)
                .push_back(argument);
        }
        if (free.size() > 1 || (free.size() == 1 && free[0]->type == ValueType::kList)) return;
        const auto count = element != nullptr ? elements(element) : 1;
        for (int i = 0; i < count; ++i) {
            Call call{service_.name, command.name, {}};
            if (!free.empty()) call.name = free[0]->name;
            call.element = element != nullptr && element == model::given_arguments(command).front();
            for (const auto* argument : model::given_arguments(command)) {
                if (argument == element) {
                    call.arguments.emplace_back(i);
                } else if (!free.empty() && argument == free[0]) {
                    call.arguments.emplace_back();
                } else {
                    call.arguments.push_back(hints_.argument(command, argument->name).default_value);
                }
            }
            add_call(command, free.empty() ? nullptr : free[0], std::move(call),
                     element != nullptr ? std::optional(i) : std::nullopt);
        }
    }

    void add_call(const CommandModel& command, const Field* argument, Call call, std::optional<int> element) {
        if (argument == nullptr) {
            Entity button;
            button.kind = EntityKind::kButton;
            button.write = std::move(call);
            button.default_on = !hints_.advanced(command);
            add(std::move(button), command.name, element);
            return;
        }
        const auto hints = hints_.argument(command, argument->name);
        if (hints.quantity == "brightness" || argument->type == ValueType::kColor) {
            auto& light = lights_[element];
            light.kind = EntityKind::kLight;
            light.default_on = light.default_on && !hints_.advanced(command);
            (argument->type == ValueType::kColor ? light.color : light.write) = std::move(call);
            if (argument->type != ValueType::kColor) describe_number(light, *argument, hints);
            return;
        }
        Entity entity;
        entity.write = std::move(call);
        entity.default_on = !hints_.advanced(command);
        if (argument->type == ValueType::kText) {
            entity.kind = EntityKind::kText;
            entity.max_length = argument->max_length.value_or(kUsualTextBytes);
        } else {
            describe_number(entity, *argument, hints);
            make_settable(entity, *argument, hints);
        }
        if (const auto shown = hints_.shown_by(command)) show_by(entity, *shown, element);
        add(std::move(entity), argument->name, element);
    }

    static void make_settable(Entity& entity, const Field& argument, const FieldHints& hints) {
        entity.options = two_values(argument, hints);
        if (!entity.options.empty() && (argument.names.empty() || names_say_all(argument))) {
            entity.kind = EntityKind::kSwitch;
        } else if (names_say_all(argument)) {
            entity.kind = EntityKind::kSelect;
            entity.options = named_numbers(argument);
        } else {
            entity.kind = EntityKind::kNumber;
            entity.options.clear();
        }
    }

    void show_by(Entity& entity, const model::ModelHints::Shown& shown, std::optional<int> element) {
        const auto* event = model_.event_named(shown.event);
        if (event == nullptr) return;
        std::string pointer = "/" + event->name;
        if (event->shape == EventShape::kPerElement) {
            pointer += "/" + std::to_string(element.value_or(0));
            if (event->fields.size() > 1) pointer += "/" + shown.field;
        } else if (event->shape == EventShape::kOnce || event->fields.size() > 1) {
            pointer += "/" + shown.field;
        }
        entity.read = ValuePlace{service_.name, pointer};
        shown_.insert({shown.event, shown.field});
    }

    void add_lights() {
        for (auto& [element, light] : lights_)
            add(light, "", element);
    }

    /// Commands that undo others: their effect is that of a value of the others.
    void find_undoing() {
        undoes_.insert("");
        for (const auto& command : model_.commands)
            if (command.safe && command.safe->command != command.name) undoes_.insert(command.safe->command);
        if (const auto stop = stop_call(); stop && stop->arguments.empty()) undoes_.insert(stop->command);
    }

    /// What brings the whole service to its safe state, where that is one command: "T,P,0,0".
    std::optional<Call> stop_call() const {
        if (model_.safe.size() != 1 || model_.safe[0].size() < 3) return std::nullopt;
        const auto& line = model_.safe[0];
        const auto* command = model_.command_with_tag(line[2]);
        if (command == nullptr) return std::nullopt;
        Call call{service_.name, command->name, {}};
        for (std::size_t at = line.find(',', 2); at != std::string::npos; at = line.find(',', at + 1)) {
            char* end = nullptr;
            const double value = std::strtod(line.c_str() + at + 1, &end);
            if (end == line.c_str() + at + 1) return std::nullopt;
            call.arguments.emplace_back(value);
        }
        if (call.arguments.size() != model::given_arguments(*command).size()) return std::nullopt;
        return call;
    }

    void add_stop() {
        auto call = stop_call();
        if (!call) return;
        Entity button;
        button.kind = EntityKind::kButton;
        button.write = std::move(call);
        button.default_on = std::any_of(result_.begin(), result_.end(), [](const Entity& each) {
            return each.settable() && each.default_on;
        });
        add(std::move(button), "stop", std::nullopt);
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
        for (auto& entity : result_) {
            const auto& part = parts_[entity.id];
            entity.name = label.empty() ? capital(words_of(service_.name)) : label;
            if (part.element && (numbers.size() > 1 || label.empty()))
                entity.name += " " + std::to_string(*part.element);
            const bool alone = in_element[part.element] == 1 && (part.element || parts_.size() == 1);
            if (!part.field.empty() && slug_of(part.field) != slug_of(service_.name) &&
                (!alone || label.empty()))
                entity.name += " " + words_of(part.field);
        }
    }

    const model::Description& description_;
    const model::ServiceInfo& service_;
    const model::ServiceModel& model_;
    std::shared_ptr<const model::ModelHints> shared_hints_;
    const model::ModelHints& hints_ = *shared_hints_;
    std::set<std::string> undoes_;
    std::set<std::pair<std::string, std::string>> shown_;  // event and field: an entity that is set shows it
    std::map<std::optional<int>, Entity> lights_;
    std::map<std::string, Part> parts_;
    std::vector<Entity> result_;
};

/// Names of services may differ in what a slug has not.
void make_unique(std::vector<Entity>& entities) {
    std::set<std::string> seen;
    for (auto& entity : entities) {
        const auto id = entity.id;
        for (int n = 2; !seen.insert(entity.id).second; ++n)
            entity.id = id + "-" + std::to_string(n);
    }
}

}  // namespace

std::string slug_of(std::string_view text) {
    std::string slug;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80 && std::isalnum(byte) != 0) {
            slug += static_cast<char>(std::tolower(byte));
        } else if (!slug.empty() && slug.back() != '-') {
            slug += '-';
        }
    }
    while (!slug.empty() && slug.back() == '-')
        slug.pop_back();
    return slug.empty() ? "x" : slug;
}

std::vector<Entity> entities_of(const model::Description& description, const FindModel& find_model) {
    std::vector<Entity> result;
    const model::ServiceInfo* io = nullptr;
    for (const auto& service : description.services) {
        const auto model = find_model(service);
        if (!model) continue;
        if (model->name == "io") {
            io = &service;
            continue;
        }
        auto more = ServiceEntities(description, service, model).make();
        std::move(more.begin(), more.end(), std::back_inserter(result));
    }
    if (io != nullptr) {
        auto more = pin_entities(description, *io);
        std::move(more.begin(), more.end(), std::back_inserter(result));
    }
    if (result.size() > kMaxEntities) result.resize(kMaxEntities);
    make_unique(result);
    return result;
}

}  // namespace asip::gateway::exports
