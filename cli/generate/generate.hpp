// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::generate {

/// A file of generated text.
struct GeneratedFile {
    std::string name;  ///< without folder
    std::string text;
    bool own_code = false;  ///< for a person to write in: never written over
};
using Files = Expected<std::vector<GeneratedFile>>;

// Each is a pure function of the model. It fails with a reason for a person where the model has a shape that
// it cannot express, or two of its names become one in the language.

/// An Arduino sketch with a service class: NAME.ino, the class, and the file with its hardware. `sketch` is
/// the name of the sketch and its folder; `elements`, 1 to 100, is how many elements the board has.
Files firmware(const model::ServiceModel& model, const std::string& sketch, std::size_t elements);

/// A board file for asip-sim: the board, and a part that stands for the hardware of firmware()'s sketch.
/// `image` and `link` stand in it as they are.
Files simulated_part(const model::ServiceModel& model, const std::string& image, std::size_t elements);

/// A typed client of the service over the bus, and tests made from the examples.
Files cpp_client(const model::ServiceModel& model);

/// The usual name of the sketch: "Fan".
std::string sketch_name(const model::ServiceModel& model);
/// The name by which the sketch announces the service, which finds the model: "Fan".
std::string announced_name(const model::ServiceModel& model);

}  // namespace asip::generate
