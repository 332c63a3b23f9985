#pragma once
#include <functional>
#include <memory>
#include <string>

#include "sim/alarm.hpp"
#include "sim/config.hpp"
#include "sim/part.hpp"
#include "sim/wiring.hpp"

namespace asip::sim {

/// What a part has of its board. Outlives the part.
struct PartContext {
    Wiring& wiring;
    AlarmClock& clock;
    double cycles_per_us;
    std::function<void(const Part&)> changed;  ///< call it when state() has become another one
};

// One function per kind of part; each part is in its own file.
std::unique_ptr<Part> make_part(const std::string& name, const LedSpec& spec, PartContext& context);
std::unique_ptr<Part> make_part(const std::string& name, const ButtonSpec& spec, PartContext& context);
std::unique_ptr<Part> make_part(const std::string& name, const WireSpec& spec, PartContext& context);
std::unique_ptr<Part> make_part(const std::string& name, const PotentiometerSpec& spec, PartContext& context);
std::unique_ptr<Part> make_part(const std::string& name, const UltrasonicSpec& spec, PartContext& context);
std::unique_ptr<Part> make_part(const std::string& name, const ServoSpec& spec, PartContext& context);
std::unique_ptr<Part> make_part(const std::string& name, const SquareWaveSpec& spec, PartContext& context);

}  // namespace asip::sim
