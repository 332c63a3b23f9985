// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "asip/model/service_model.hpp"

namespace asip::generate {

/// Picks an element of the service: it is called as an element is; may be null.
const model::Field* element_argument(const model::ServiceModel& model, const model::CommandModel& command);

/// Unless the user says: as the examples show, 1 to 16.
std::size_t elements_in_examples(const model::ServiceModel& model);

/// Both included.
struct WholeRange {
    double low, high;
    bool fits(double least, double most) const { return low >= least && high <= most; }
};
/// The range of an integer or a color; where the model has no bounds, those of 32 bits.
WholeRange whole_range(const model::Field& field);

/// A voltage or a level in place of real hardware: `low` to `high` is 0 to 5 V of an analog pin, 0 to 100 %
/// of PWM, or two levels.
struct StandIn {
    const model::Field* field = nullptr;  ///< of an event, or an argument
    std::string value;                    ///< "speed", what a person calls it
    bool output = false;                  ///< the board writes it
    bool digital = false;
    std::int32_t low = 0, high = 0;
    std::vector<int> pins;  ///< numbers of an Uno, one for each element or one alone
};

/// Pins of an Uno for fields of events, then arguments of commands, as long as pins are left. Text, colors
/// and lists get none.
std::vector<StandIn> stand_ins(const model::ServiceModel& model, std::size_t elements);

/// As the Arduino core calls it: "5", "A0".
std::string pin_name(int pin);

}  // namespace asip::generate
