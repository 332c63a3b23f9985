// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "asip/model/service_model.hpp"

namespace asip::model {

/// What a model says of a field or an argument for other systems (Home Assistant, say).
struct FieldHints {
    std::string quantity;                 ///< "distance"; empty: not said
    std::optional<double> step;           ///< the smallest difference that makes sense
    std::optional<double> default_value;  ///< of an argument
    std::optional<std::int64_t> on;       ///< of a field of two values: the one that means on
    bool advanced = false;                ///< hidden at first
};

/// The optional members of a model that only other systems need. They are not in ServiceModel: no program but
/// a gateway that exports reads them, and most models have few.
class ModelHints {
  public:
    /// Where a command's effect is seen.
    struct Shown {
        std::string event, field;
    };

    explicit ModelHints(const ServiceModel& model);

    FieldHints field(const EventModel& event, std::string_view field) const;
    FieldHints argument(const CommandModel& command, std::string_view argument) const;
    bool advanced(const CommandModel& command) const;
    /// The event and field that show what the command set; none: the model does not say.
    std::optional<Shown> shown_by(const CommandModel& command) const;
    /// How many elements the model says that there are; none: it does not say, or as many as pins.
    std::optional<int> elements() const { return elements_; }
    bool element_for_each_pin() const { return element_for_each_pin_; }

  private:
    std::map<std::string, FieldHints, std::less<>> fields_;  // by "e.EVENT.FIELD", "c.COMMAND.ARGUMENT"
    std::map<std::string, Shown, std::less<>> shown_;        // by command
    std::map<std::string, bool, std::less<>> advanced_;      // by command
    std::optional<int> elements_;
    bool element_for_each_pin_ = false;
};

/// The reason why such a member contradicts the rest of the model, with its place; empty: none does.
/// `document` fits the schema, and `model` was made of it.
std::string hints_fault(const ServiceModel& model, const nlohmann::json& document);

}  // namespace asip::model
