// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/expected.hpp"

namespace asip::text {
class JsonReader;
}

/// What people say that a property is: pin 2 is a door, pin 13 a lamp that lights when its level is low. The
/// board's agent keeps meanings; they stand in its description as `meanings`.
namespace asip::model {

inline constexpr std::size_t kMaxMeanings = 64;             ///< of a board
inline constexpr std::size_t kMaxMeaningsBytes = 8 * 1024;  ///< of a board, as JSON
inline constexpr std::size_t kMaxPropertyIdBytes = 200;     ///< SERVICE/ELEMENT/COMMAND.ARGUMENT
inline constexpr int kMaxDebounceMs = 1000;

/// What a class says of its pin.
enum class ClassUse {
    kInput,   ///< the pin is read: door, button, motion
    kOutput,  ///< the pin is set: light, plug, fan
    kNumber   ///< a number has it: temperature
};

/// With the use of each, in the order of help.
const std::vector<std::pair<std::string, ClassUse>>& meaning_classes();
/// Nothing: there is no such class.
std::optional<ClassUse> use_of_class(std::string_view name);

struct Meaning {
    std::string klass;               ///< a word of meaning_classes(); empty: none
    std::optional<bool> inverted;    ///< low means on; none: only an input with pull-up is inverted
    std::optional<int> debounce_ms;  ///< none: as its class has it
    std::string unit;                ///< of the value that `line` gives
    /// A straight line through {raw0, raw1, value0, value1}, with raw0 != raw1.
    std::optional<std::array<double, 4>> line;
    std::string icon;
    bool hidden = false;

    friend bool operator==(const Meaning&, const Meaning&) = default;
};

/// By the id of the property.
using Meanings = std::map<std::string, Meaning, std::less<>>;
/// By the id of the property: members to set, `null` to remove; `null` in place of all removes the meaning.
using MeaningChanges = std::map<std::string, nlohmann::json, std::less<>>;

/// Adds a person's words for the property `id`: `class=door`, `inverted=yes`, `debounce=50`, `unit=%`,
/// `line=0:1023:0:100`, `icon=mdi:door`, `hidden=yes`; `class-` removes. Fails with what to write. False:
/// another key.
Expected<bool> add_meaning(MeaningChanges& changes, const std::string& id, std::string_view text);

/// Fails beyond the bounds.
Expected<Meanings> changed(Meanings meanings, const MeaningChanges& changes);

nlohmann::json to_json(const Meaning& meaning);
/// Adds the member `meanings`, unless it is empty.
void put_meanings(nlohmann::json& object, const Meanings& meanings);
/// Faults: impossible ids, unknown classes, wrong types, more than the bounds.
Meanings read_meanings(text::JsonReader& reader);
/// In this form `null` removes.
MeaningChanges read_meaning_changes(text::JsonReader& reader);
/// Unknown members are passed over.
Meaning read_meaning(text::JsonReader& reader);

}  // namespace asip::model
