// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "asip/model/service_model.hpp"

namespace asip::generate {

/// The argument by which a command picks one element of the service: the one that is called as an element is;
/// null where there is none.
const model::Field* element_argument(const model::ServiceModel& model, const model::CommandModel& command);

/// How many elements a board is made with unless the user says: as many as the examples show, 1 to 16.
std::size_t elements_in_examples(const model::ServiceModel& model);

/// Whole numbers that a field may have, both included.
struct WholeRange {
    double low, high;
    bool fits(double least, double most) const { return low >= least && high <= most; }
};
/// The range of an integer or a color; where the model has no bounds, those of 32 bits.
WholeRange whole_range(const model::Field& field);

/// A voltage or a level that stands for a value until real hardware is there: `low` to `high` is 0 to 5 V of
/// an analog pin, 0 to 100 % of a PWM pin, or the two levels of a digital one.
struct StandIn {
    const model::Field* field = nullptr;  ///< of an event, or an argument
    std::string value;                    ///< "speed", what a person calls it
    bool output = false;                  ///< the board writes it
    bool digital = false;
    std::int32_t low = 0, high = 0;
    std::vector<int> pins;  ///< numbers of an Uno, one for each element or one alone
};

/// The pins of an Uno for the values of a service with so many elements: fields of its events, then arguments
/// of its commands, as long as pins are left. Text, colors and lists have none.
std::vector<StandIn> stand_ins(const model::ServiceModel& model, std::size_t elements);

/// As the Arduino core calls a pin: "5", "A0".
std::string pin_name(int pin);

}  // namespace asip::generate
