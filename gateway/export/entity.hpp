// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace asip::gateway::exports {

enum class EntityKind { kSensor, kBinarySensor, kSwitch, kNumber, kLight, kButton, kText, kSelect };

inline constexpr double kFullBrightness = 255;  ///< of a light
inline constexpr double kMaxColor = 0xffffff;

/// Where a value stands in what a service publishes.
struct ValuePlace {
    std::string service;
    std::string pointer;  ///< JSON pointer: "/distance/0", "/digital/13", "/heading/heading"
    friend bool operator==(const ValuePlace&, const ValuePlace&) = default;
};

/// An argument of a call: a number, or the value that is set where there is none.
using CallArgument = std::optional<double>;

/// A command of a service that sets a value.
struct Call {
    std::string service;
    std::string command;
    std::vector<CallArgument> arguments;
    std::string name{};    ///< of the argument that the value is
    bool element = false;  ///< the first argument says which element is meant
    friend bool operator==(const Call&, const Call&) = default;
};

/// One thing that a board shows or lets be set. All dialects are functions of these, and of their values.
///
/// Values are JSON: a number (sensor, number), true or false (binary sensor, switch), a text (text, select:
/// one of the options). That of a light is {"on":true,"brightness":0..255,"color":0xrrggbb}, without what it
/// does not have. A button has none.
struct Entity {
    std::string id;  ///< stable, of `a-z0-9-`: "distance-0", "servo-1-angle", "pin-13"
    EntityKind kind = EntityKind::kSensor;
    std::string name;  ///< for people
    std::string unit;  ///< as the model has it; may be empty
    std::string quantity;
    bool whole = false;  ///< a number without fraction
    std::optional<double> min, max, step;
    std::size_t max_length = 0;  ///< of a text, or a sensor whose value is one; 0: no text
    /// Of a select: its words and their numbers. Of a switch and a binary sensor: {"off", N} and {"on", M}.
    std::vector<std::pair<std::string, double>> options;
    std::optional<ValuePlace> read;  ///< none: what was set is all that is known
    std::optional<Call> write;       ///< of a light: its brightness
    std::optional<Call> color;       ///< of a light
    std::optional<Call> before;      ///< sent ahead of `write`: what makes a pin an output
    bool default_on = true;          ///< false: a dialect hides it at first

    bool settable() const { return write.has_value() || color.has_value(); }
    /// That shows it, or sets it.
    const std::string& service() const {
        return read ? read->service : write ? write->service : color->service;
    }
    friend bool operator==(const Entity&, const Entity&) = default;
};

/// A command as it goes to a service: {"write":[0,90]}.
struct Request {
    std::string service;
    std::string payload;
    friend bool operator==(const Request&, const Request&) = default;
};

/// As JSON: a whole number without a point, as boards take it.
nlohmann::json json_number(double value);

/// The value of an entity in what its service published, null where the board has none; nothing: it is not in
/// there. Any JSON may be given.
std::optional<nlohmann::json> value_in(const Entity& entity, const nlohmann::json& published);

/// What sets an entity to a value, in order. Empty: no such value, or it cannot be set.
std::vector<Request> requests_for(const Entity& entity, const nlohmann::json& value);

/// The value of an entity that is set, by what the commands that its board executed have set in the service:
/// `asip/BOARD/SERVICE/set`, {"write":{"0":90}}. Nothing: it is not known.
std::optional<nlohmann::json> value_set(const Entity& entity, const nlohmann::json& set);

}  // namespace asip::gateway::exports
