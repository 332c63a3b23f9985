// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "cli/generate/generate.hpp"
#include "cli/generate/layout.hpp"
#include "cli/generate/names.hpp"

namespace asip::generate {

Files simulated_part(const model::ServiceModel& model, const std::string& image, std::size_t elements) {
    using Json = nlohmann::ordered_json;
    Json inputs = Json::array(), outputs = Json::array();
    for (const auto& stand_in : stand_ins(model, elements)) {
        for (std::size_t i = 0; i < stand_in.pins.size(); ++i) {
            const auto pin = pin_name(stand_in.pins[i]);
            Json value{{"name", stand_in.value + (stand_in.pins.size() > 1 ? std::to_string(i) : "")},
                       {"pin", pin.front() == 'A' ? Json(pin) : Json(stand_in.pins[i])},
                       {"min", stand_in.low},
                       {"max", stand_in.high}};
            (stand_in.output ? outputs : inputs).push_back(std::move(value));
        }
    }
    if (inputs.empty() && outputs.empty())
        return fail(
            "none of its values is a number that a voltage could stand for; docs/asip-sim.md lists the parts "
            "that can be wired instead");
    const auto name = snake_case(model.name);
    const Json board{{"name", name},
                     {"image", image},
                     {"link", name + ".port"},
                     {"parts", Json::array({Json{{"kind", "values"},
                                                 {"name", name},
                                                 {"inputs", std::move(inputs)},
                                                 {"outputs", std::move(outputs)}}})}};
    return std::vector<GeneratedFile>{{name + ".board.json", board.dump(2) + "\n"}};
}

}  // namespace asip::generate
