// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "sim/chip/alarm.hpp"
#include "sim/chip/i2c_bus.hpp"
#include "sim/wiring/part.hpp"
#include "sim/wiring/wiring.hpp"

namespace asip::sim {
namespace world {
class World;
}

/// Outlives the part.
struct PartContext {
    Wiring& wiring;
    AlarmClock& clock;
    I2cBus& i2c;
    double cycles_per_us;
    std::function<void(const Part&)> changed;  ///< must be called when state() has changed
    /// Other than its state: "lap 24.100".
    std::function<void(const Part&, std::string)> happened;
    std::shared_ptr<world::World> world;  ///< null: the board stands in none
};

/// For a part whose constructor takes a name, a spec and a context.
template <class Made, class Spec>
auto maker(const Spec& spec) {
    return [spec](std::string name, PartContext& context) -> std::unique_ptr<Part> {
        return std::make_unique<Made>(std::move(name), spec, context);
    };
}

}  // namespace asip::sim
