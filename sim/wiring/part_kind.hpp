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

/// What a part does with a pin. Parts that listen share a pin with wires, but not with each other; a bus is
/// shared by all, a button that shorts it among them.
enum class PinUse { kListens, kJoins, kDrives, kBus };

struct PinClaim {
    int pin = 0;  ///< Arduino pin number, maybe one that the board does not have
    PinUse use = PinUse::kListens;
    bool analog = false;  ///< must be an analog input
};

/// One part as its settings describe it.
struct PartPlan {
    std::vector<PinClaim> claims;  ///< at least one; a part without a name is named after the first
    unsigned timers = 0;           ///< of the simulator that it needs
    /// The context outlives the part. The part takes its pins at once.
    std::function<std::unique_ptr<Part>(std::string name, PartContext& context)> make;
};

struct PartVerb {
    std::string_view name;      ///< "set"
    std::string_view argument;  ///< "0..1"; empty: it takes none
    std::string_view help;      ///< "turn a potentiometer"
};

/// All that the simulator knows of a kind of part: how it is read from a board file, and which commands it
/// has to do. Each kind is one file in sim/parts/, which defines one function that sim/CMakeLists.txt lists.
struct PartKind {
    std::string_view name;  ///< "led", as in a board file
    std::span<const PartVerb> verbs;
    /// Reads the settings. What is wrong with them is reported to the reader; the plan is unused then.
    PartPlan (*read)(PartReader& reader);

    /// Null if there is no such verb.
    const PartVerb* verb(std::string_view name) const;

    /// All of them, in the order in which they are listed to a person.
    static std::span<const PartKind* const> all();
    /// Null if there is no such kind.
    static const PartKind* find(std::string_view name);
};

}  // namespace asip::sim
