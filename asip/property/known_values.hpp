// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/model/command_encoder.hpp"
#include "asip/property/contact.hpp"
#include "asip/property/property.hpp"
#include "asip/time.hpp"

namespace asip::property {

enum class How {
    kNone,      ///< it is not: Known::why
    kReported,  ///< the board said it by itself
    kAnswered,  ///< the board said it when it was asked
    kSet        ///< a command that the board executed set it
};
enum class Unknown {
    kNever,    ///< nothing was reported or set yet
    kRestart,  ///< the board restarted, was away, or may have
    kDoubt     ///< a command may or may not have been executed, or its effect is not told
};
std::string_view to_text(How how);
std::string_view to_text(Unknown why);

struct Known {
    nlohmann::json value{};  ///< null and a `how`: the board says that it has none
    How how = How::kNone;
    Unknown why = Unknown::kNever;
    Time since{};  ///< when it was last said or set; of an unknown one, when it became so
};

/// How a board stands, by its reports and executed commands; the agent's. Raw values are kept, so that
/// another meaning shows the same level anew. Pure.
class KnownValues {
  public:
    /// What was known of a property that is read or set in the same way stays.
    void use(std::vector<Property> properties, Time now);
    const std::vector<Property>& properties() const { return properties_; }

    // Each of these says whether it changed more than the time of a value.

    /// Published by a service, decoded by its model.
    bool reported(std::string_view service, const nlohmann::json& published, How how, Time now);
    /// The board executed it, or perhaps did.
    bool executed(std::string_view service, const model::RequestValues& request, bool perhaps, Time now);
    /// The board restarted, or was away.
    bool forget(Time now);
    /// At next_deadline(): contacts are quiet again, buttons are held.
    bool tick(Time now);
    std::optional<Time> next_deadline() const { return due_; }

    /// A pin is about to become an input: levels count from now on.
    void input_begins(std::string_view io, int pin);
    /// The board executed that. It says the level of a high pin; without an event it is low.
    bool input_began(std::string_view io, int pin, Time now);

    /// Electrical: {"digital":{"2":1},"analog":{"0":320}}.
    nlohmann::json pins(std::string_view io) const;
    /// By the number of the property.
    Known known(std::size_t property) const;
    std::vector<ButtonEvent> events(std::size_t property, Time now) const;

  private:
    struct Raw {
        nlohmann::json value{}, color{};  // color: of a light
        How how = How::kNone;
        Unknown why = Unknown::kNever;
        Time since{};
        double sum = 0;
        Contact contact{};
    };
    struct Heard {
        nlohmann::json value;
        Time when{};
    };
    static bool take(const Property& property, Raw& raw, const nlohmann::json& value, How how, Time now);
    bool take_contact(const Property& property, Raw& raw, const nlohmann::json& level, How how, Time now);
    bool count(const Property& property, Raw& raw, const nlohmann::json& level, How how, Time now);
    void look_again(const Contact& contact);
    static bool lose(Raw& raw, Unknown why, Time now);
    bool set_by(const Property& property, const Setter& setter, Raw& raw, const nlohmann::json& values,
                bool perhaps, Time now) const;

    std::vector<Property> properties_;
    std::vector<Raw> raws_;  // one for each property
    /// What all pins said, by service and pointer: a board says the level of a new input before it confirms
    /// the mode.
    std::map<std::string, Heard, std::less<>> pins_;
    std::uint64_t next_event_ = 1;
    std::optional<Time> due_;
};

}  // namespace asip::property
