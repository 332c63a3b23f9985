// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::generate {

struct GeneratedFile {
    std::string name;  ///< without folder
    std::string text;
    bool own_code = false;  ///< for a person to write in: never written over
};
using Files = Expected<std::vector<GeneratedFile>>;

// Each is a pure function of the model. It fails with a reason for a person where the model has a shape that
// it cannot express, or two of its names become one in the language.

/// NAME.ino, the service's class, and the file with its hardware. `sketch`: name of sketch and folder;
/// `elements`: 1 to 100.
Files firmware(const model::ServiceModel& model, const std::string& sketch, std::size_t elements);

/// NAME.ino of a board with these services of the library, each as `servo=9,10` or `weather`. The table of
/// what each needs is templates/services.json.
Files services_sketch(const std::vector<std::string>& services, const std::string& sketch);

/// For asip-sim: the board, and a part in place of firmware()'s hardware. `image` and `link` are written as
/// they are.
Files simulated_part(const model::ServiceModel& model, const std::string& image, std::size_t elements);

/// A typed client, and tests made from the examples.
Files cpp_client(const model::ServiceModel& model);

/// As usual: "Fan".
std::string sketch_name(const model::ServiceModel& model);
/// By which the sketch announces the service, and the model is found: "Fan".
std::string announced_name(const model::ServiceModel& model);

}  // namespace asip::generate
