// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/model/service_model.hpp"

namespace asip::model {

/// What a model says of a field or argument for other systems.
struct FieldHints {
    std::string quantity;                 ///< "distance"; empty: not said
    std::optional<double> step;           ///< the smallest difference that makes sense
    std::optional<double> default_value;  ///< of an argument
    std::optional<std::int64_t> on;       ///< of a field of two values: the one that means on
    std::optional<double> none;           ///< of a field: the number that says that there is no value
    bool advanced = false;                ///< hidden at first
    bool sum = false;                     ///< of a field: each event adds to it
};

/// The optional members that say what values mean.
class ModelHints {
  public:
    /// Where a command's effect is seen.
    struct Shown {
        std::string event, field;
    };
    /// What a command sets beside its own argument: member of `sets`, [ELEMENT/]NAME.
    struct Sets {
        std::optional<int> element;  ///< none: the command's own element, else all
        std::string name;            ///< of the argument of another command
        std::string argument;        ///< of this command; empty: `value`
        std::optional<double> value{};
    };

    explicit ModelHints(const ServiceModel& model);

    FieldHints field(const EventModel& event, std::string_view field) const;
    FieldHints argument(const CommandModel& command, std::string_view argument) const;
    bool advanced(const CommandModel& command) const;
    /// None: the model does not say.
    std::optional<Shown> shown_by(const CommandModel& command) const;
    /// Null: the model does not say.
    const std::vector<Sets>* sets(const CommandModel& command) const;
    /// Elements of the service; none: not said, or as many as pins.
    std::optional<int> elements() const { return elements_; }
    bool element_for_each_pin() const { return element_for_each_pin_; }

  private:
    std::map<std::string, FieldHints, std::less<>> fields_;  // by "e.EVENT.FIELD", "c.COMMAND.ARGUMENT"
    std::map<std::string, Shown, std::less<>> shown_;        // by command
    std::map<std::string, std::vector<Sets>, std::less<>> sets_;
    std::map<std::string, bool, std::less<>> advanced_;  // by command
    std::optional<int> elements_;
    bool element_for_each_pin_ = false;
};

/// Why such a member contradicts the model, with its place; empty: none does. `document` fits the schema,
/// `model` is made of it.
std::string hints_fault(const ServiceModel& model, const nlohmann::json& document);

}  // namespace asip::model
