// SPDX-License-Identifier: Apache-2.0
#include "bench/load/board_kind.hpp"

#include <algorithm>
#include <set>

#include "asip/text/nearest.hpp"

namespace asip::load {
namespace {

// A few sketches in common, as a site has them.
constexpr std::size_t kSketches = 8;
constexpr int kBaud = 500000;
constexpr std::size_t kPortsOfOneHost = 4;

}  // namespace

const BoardKind::Service* BoardKind::service(std::string_view name) const {
    const auto found = std::find_if(services.begin(), services.end(),
                                    [&](const Service& one) { return one.model->name == name; });
    return found == services.end() ? nullptr : &*found;
}

model::Description BoardKind::describe(std::size_t number, const model::AgentInfo& agent) const {
    model::Description description;
    description.firmware.protocol = "0.4";
    description.firmware.chip = "ATmega328P";
    description.firmware.sketch = "Load" + std::to_string(number % kSketches);
    description.link = {"simulated", "/dev/ttyACM" + std::to_string(number % kPortsOfOneHost), kBaud};
    description.agent = agent;
    description.pins.capabilities = "00111511155511336666";
    description.pins.owners = "@@IIIIIIIIIIIIIIIIII";
    description.pins.modes = "66111111111111444444";
    for (std::uint8_t pin = 14; pin < 20; ++pin)
        description.pins.analog.emplace_back(pin, static_cast<std::uint8_t>(pin - 14));
    for (const auto& one : services) {
        model::ServiceInfo service;
        service.name = one.model->name;
        service.id = one.model->id;
        service.model = one.model->ref();
        service.title = one.model->title;
        service.count = 2;
        service.period = 100;
        description.services.push_back(std::move(service));
    }
    return description;
}

Expected<BoardKind> make_board_kind(const std::vector<std::string>& models) {
    const auto& standard = model::ModelSet::standard();
    BoardKind kind;
    std::set<std::string> seen;
    for (const auto& name : models) {
        const auto found = standard.find(name);
        if (!found)
            return fail("there is no service model \"" + name + "\"" +
                        text::did_you_mean(name, standard.names()));
        if (!seen.insert(name).second)
            return fail("\"" + name + "\" is given twice; a board has each service once");
        BoardKind::Service service{found, {}, {}};
        for (const auto& example : model::examples(*found)) {
            if (!example.error.empty() || example.json.empty()) continue;
            auto& text = example.is_event() ? service.value : service.command;
            if (text.empty()) text = example.json;
        }
        kind.services.push_back(std::move(service));
    }
    if (kind.services.size() > model::kMaxDescriptionServices)
        return fail("more than " + std::to_string(model::kMaxDescriptionServices) + " services");
    return kind;
}

}  // namespace asip::load
