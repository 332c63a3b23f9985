// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/model/json.hpp"
#include "asip/model/meaning.hpp"

/// What can be read or set on a board, from description, models and meanings: docs/properties.md.
namespace asip::property {

inline constexpr std::size_t kMaxProperties = 256;  ///< of a board
inline constexpr std::size_t kMaxOfService = 64;
inline constexpr double kFullBrightness = 255;  ///< of a light
inline constexpr double kMaxColor = 0xffffff;

/// What a property is to a person.
enum class Kind {
    kSensor,        ///< a number, a text, or one of the choices; read only
    kBinarySensor,  ///< true or false; read only
    kSwitch,        ///< true or false
    kNumber,        ///< a number that can be set
    kLight,         ///< {"on":true,"brightness":0..255,"color":0xrrggbb}, without what it does not have
    kButton,        ///< no value: it is pressed
    kText,          ///< a text that can be set
    kSelect         ///< one of the choices, and can be set
};

/// In what a service publishes.
struct Place {
    std::string service;
    std::string pointer;  ///< JSON pointer: "/distance/0", "/digital/13", "/heading/heading"
    bool sum = false;     ///< each event adds to it: what is shown is the sum since the session began
    friend bool operator==(const Place&, const Place&) = default;
};

/// A command that sets a value. A missing argument is the value.
struct Call {
    std::string service;
    std::string command;
    std::vector<std::optional<double>> arguments;
    friend bool operator==(const Call&, const Call&) = default;
};

/// How a command changes a value: the property's own, and others (`stop` sets a motor's power to 0).
struct Setter {
    std::string command;
    std::optional<std::size_t> element_at;  ///< the argument that must be `element`; none: it is for all
    int element = 0;
    std::optional<std::size_t> value_at;  ///< the argument that is the value; none: `value`
    std::optional<double> value{};        ///< none, and no `value_at`: the value is not known afterwards
    bool color = false;                   ///< of a light: sets its color
    friend bool operator==(const Setter&, const Setter&) = default;
};

struct Property {
    std::string id;  ///< SERVICE[/ELEMENT]/NAME: "distance/0", "servo/0/angle", "io/13"
    Kind kind = Kind::kSensor;
    std::string name;  ///< for people
    std::string service;
    std::string unit;      ///< may be empty
    std::string quantity;  ///< what the number measures, as in a service model
    bool whole = false;    ///< a number without a fraction
    std::optional<double> min, max, step;
    std::optional<double> none;  ///< the raw number by which the board says that it has no value
    std::size_t max_length = 0;  ///< of a text; 0: no text
    /// A select's words and numbers; {"off", N} and {"on", M} of a switch and a binary sensor.
    std::vector<std::pair<std::string, double>> choices;
    std::optional<Place> read;   ///< none: what was set is all that is known
    std::optional<Call> write;   ///< of a light: its brightness
    std::optional<Call> color;   ///< of a light
    std::optional<Call> before;  ///< sent ahead of `write`: what makes a pin an output
    std::vector<Setter> setters;
    std::string refused;  ///< why it cannot be set now, in a sentence; empty: it can, if settable()
    model::Meaning meaning;
    /// Its meaning makes the pin an input, and no mode does: its level tells nothing.
    bool floating = false;
    bool advanced = false;  ///< hidden at first: it moves something, or few people need it

    bool settable() const { return write.has_value() || color.has_value(); }
    bool hidden() const { return meaning.hidden || advanced; }
    friend bool operator==(const Property&, const Property&) = default;
};

std::string_view type_of(const Property& property);
std::string_view access_of(const Property& property);

using model::json_number;

/// "servo" of servo/0/angle.
inline std::string_view service_of(std::string_view id) {
    return id.substr(0, id.find('/'));
}

/// For systems that allow `a-z0-9-` alone: "servo-0-angle", unique.
std::string plain_id(std::string_view id);

}  // namespace asip::property
