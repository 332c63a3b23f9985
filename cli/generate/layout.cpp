// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"

namespace asip::generate {
namespace {

using model::CommandModel;
using model::EventModel;
using model::EventShape;
using model::Field;
using model::ServiceModel;
using model::ValueType;

constexpr std::size_t kMaxFromExamples = 16;
constexpr int kFirstAnalogPin = 14;
constexpr std::array kAnalogPins{14, 15, 16, 17, 18, 19};
constexpr std::array kPwmPins{5, 6, 9, 10, 3, 11};
constexpr std::array kDigitalPins{2, 4, 7, 8, 12, 13};

/// The element that an example picks, from 0; nothing where it picks none.
std::optional<std::size_t> element_picked(const ServiceModel& model, const nlohmann::json& command) {
    const auto* known = model.command(command.begin().key());
    const auto* element = known == nullptr ? nullptr : element_argument(model, *known);
    if (element == nullptr) return std::nullopt;
    const auto values = model::argument_values(*known, command.begin().value());
    const auto given = model::given_arguments(*known);
    const auto place =
        static_cast<std::size_t>(std::find(given.begin(), given.end(), element) - given.begin());
    if (!values || place >= values->size() || !(*values)[place].is_number_unsigned()) return std::nullopt;
    return (*values)[place].get<std::size_t>();
}

/// Gives out pins of one kind until there are no more.
class PinStock {
  public:
    explicit PinStock(std::span<const int> pins) : left_(pins) {}

    std::vector<int> take(std::size_t count) {
        if (count > left_.size()) return {};
        const auto taken = left_.first(count);
        left_ = left_.subspan(count);
        return {taken.begin(), taken.end()};
    }

  private:
    std::span<const int> left_;
};

bool is_number(const Field& field) {
    return field.type == ValueType::kInteger || field.type == ValueType::kNumber;
}

/// What the voltage of a pin stands for: the bounds of the field; as many values as an analog input tells
/// apart where it has none, or so many that they could not be told apart.
void set_bounds(StandIn& stand_in, const Field& field) {
    constexpr double kValues = 1023;
    constexpr double kMaxShown = 1e6;
    const bool has_min = field.min && std::abs(*field.min) <= kMaxShown;
    const bool has_max = field.max && std::abs(*field.max) <= kMaxShown;
    const double max = has_max ? std::floor(*field.max) : 0;
    const double low = has_min ? std::ceil(*field.min) : has_max ? max - kValues : 0;
    const double high = has_max && max > low ? max : low + kValues;
    stand_in.low = static_cast<std::int32_t>(low);
    stand_in.high = static_cast<std::int32_t>(high);
    stand_in.digital = field.type == ValueType::kInteger && low == 0 && high == 1;
}

class Planner {
  public:
    Planner(const ServiceModel& model, std::size_t elements) : model_(model), elements_(elements) {
        for (const auto& event : model.events)
            add_event(event);
        for (const auto& command : model.commands)
            add_command(command);
    }

    std::vector<StandIn> take() { return std::move(result_); }

  private:
    void add_event(const EventModel& event) {
        const bool elements = event.shape == EventShape::kPerElement;
        if (!elements && event.shape != EventShape::kOnce && event.shape != EventShape::kPlain) return;
        for (const auto& field : event.fields)
            if (is_number(field))
                add(field, event.fields.size() == 1 ? event.name : event.name + "." + field.name, false,
                    elements ? elements_ : 1);
    }

    void add_command(const CommandModel& command) {
        if (command.tag == 'A') return;  // the period of reports
        const auto* element = element_argument(model_, command);
        std::vector<const Field*> values;
        for (const auto& argument : command.args)
            if (&argument != element && is_number(argument)) values.push_back(&argument);
        for (const auto* value : values) {
            auto name = command.name;
            if (values.size() > 1 || is_taken(name)) name += "." + value->name;
            add(*value, name, true, element == nullptr ? 1 : elements_);
        }
    }

    bool is_taken(const std::string& name) const {
        return std::any_of(result_.begin(), result_.end(),
                           [&](const StandIn& other) { return other.value == name; });
    }

    void add(const Field& field, const std::string& value, bool output, std::size_t count) {
        StandIn stand_in;
        stand_in.field = &field;
        stand_in.value = value;
        stand_in.output = output;
        set_bounds(stand_in, field);
        auto& stock = stand_in.digital ? digital_ : output ? pwm_ : analog_;
        stand_in.pins = stock.take(count);
        if (!stand_in.pins.empty()) result_.push_back(std::move(stand_in));
    }

    const ServiceModel& model_;
    std::size_t elements_;
    PinStock analog_{kAnalogPins}, pwm_{kPwmPins}, digital_{kDigitalPins};
    std::vector<StandIn> result_;
};

}  // namespace

const Field* element_argument(const ServiceModel& model, const CommandModel& command) {
    if (model.element.empty()) return nullptr;
    for (const auto& argument : command.args)
        if (argument.type == ValueType::kInteger && argument.name == model.element) return &argument;
    return nullptr;
}

std::size_t elements_in_examples(const ServiceModel& model) {
    std::size_t most = 1;
    for (const auto& example : model::examples(model)) {
        const auto document = model::parse_json(example.json);
        if (!document || !document->is_object() || document->empty() || !example.error.empty()) continue;
        if (const auto picked = element_picked(model, *document)) most = std::max(most, *picked + 1);
        const auto* event = model.event_named(document->begin().key());
        if (example.is_event() && event != nullptr && event->shape == EventShape::kPerElement)
            most = std::max(most, document->begin().value().size());
    }
    return std::min(most, kMaxFromExamples);
}

WholeRange whole_range(const Field& field) {
    WholeRange range{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()};
    if (field.min) range.low = std::ceil(*field.min);
    if (field.max) range.high = std::floor(*field.max);
    return range;
}

std::vector<StandIn> stand_ins(const ServiceModel& model, std::size_t elements) {
    return Planner(model, elements).take();
}

std::string pin_name(int pin) {
    return pin >= kFirstAnalogPin ? "A" + std::to_string(pin - kFirstAnalogPin) : std::to_string(pin);
}

}  // namespace asip::generate
