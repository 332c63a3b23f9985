// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace asip::sim {

class Part;
class PartReader;
struct PartContext;

/// Listeners share a pin with wires, not with each other; a bus is shared by all.
enum class PinUse { kListens, kJoins, kDrives, kBus };

struct PinClaim {
    int pin = 0;  ///< Arduino pin number, maybe one that the board does not have
    PinUse use = PinUse::kListens;
    bool analog = false;  ///< must be an analog input
};

struct PartPlan {
    std::vector<PinClaim> claims;  ///< at least one; a part without a name is named after the first
    unsigned timers = 0;           ///< of the simulator that it needs
    /// The part takes its pins at once.
    std::function<std::unique_ptr<Part>(std::string name, PartContext& context)> make;
};

struct PartVerb {
    std::string_view name;      ///< "set"
    std::string_view argument;  ///< "0..1"; empty: it takes none
    std::string_view help;      ///< "turn a potentiometer"
};

/// How a kind of part is read, and its commands. Each is one file in sim/parts/ with one function, listed in
/// sim/CMakeLists.txt.
struct PartKind {
    std::string_view name;  ///< "led", as in a board file
    std::span<const PartVerb> verbs;
    /// Faults go to the reader; the plan is unused then.
    PartPlan (*read)(PartReader& reader);

    const PartVerb* verb(std::string_view name) const;

    /// As listed to a person.
    static std::span<const PartKind* const> all();
    static const PartKind* find(std::string_view name);
};

}  // namespace asip::sim
