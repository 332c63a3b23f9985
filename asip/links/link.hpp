// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/expected.hpp"
#include "asip/property/property.hpp"
#include "asip/time.hpp"

/// Rules that the agent of the target's board executes: docs/links.md.
namespace asip::links {

inline constexpr std::size_t kMaxLinks = 100;       ///< of a board
inline constexpr std::size_t kMaxOfAUser = 50;      ///< of these, where the bus knows users
inline constexpr std::size_t kMaxLinkBytes = 1536;  ///< of one, as JSON: all are one message

/// When a link acts.
enum class When {
    kFollows,   ///< the target has the value of the source
    kInverted,  ///< on while the source is off
    kAbove,     ///< on while the source is above a level
    kBelow,     //
    kToggles,   ///< each press switches the target
    kPress,     ///< each of these sets the target
    kRelease,   //
    kHold,      //
    kDouble
};
std::string_view to_text(When when);
std::vector<std::string_view> when_words();
std::optional<When> when_of(std::string_view word);
/// It acts on what happens; the others keep the target as the source is.
inline bool is_event(When when) {
    return when >= When::kToggles;
}

struct Link {
    std::string name;    ///< of no other link of the board
    std::string board;   ///< of the source
    std::string source;  ///< id of a property there
    When when = When::kFollows;
    std::optional<double> level;  ///< of kAbove and kBelow
    std::optional<double> back;   ///< where that ends; none: at `level`
    std::string target;           ///< id of a property; of a service where there is a command
    nlohmann::json command{};     ///< what is sent to that service; null: the property is set
    nlohmann::json value{};       ///< that the target gets; null: on, or the value of the source
    nlohmann::json otherwise{};   ///< that it gets in the other case; null: off, or nothing where `value` is
                                  ///< no such
    std::optional<std::array<double, 4>> line;   ///< from 0..1 of the source to 2..3 of the target
    Duration after{};                            ///< the condition holds for so long first
    Duration lasts{};                            ///< then the target gets `otherwise`; 0: never
    std::optional<std::pair<int, int>> between;  ///< minutes of the day, the second may be before the first
    bool safe = false;                           ///< the target is made safe when the source is not there
    bool enabled = true;
    std::string user{};  ///< who set it; empty: the bus knows no users

    friend bool operator==(const Link&, const Link&) = default;
};

nlohmann::json to_json(const Link& link);
/// From what anyone may have written. Fails with the first fault and its place; a condition that cannot be is
/// one.
Expected<Link> read_link(const nlohmann::json& document);
/// "22:00-06:00". Fails with how it is written.
Expected<std::pair<int, int>> parse_between(std::string_view text);

/// Whether a switch, a contact or a light is on; nothing: the value is another one.
std::optional<bool> on_of(const nlohmann::json& value);
/// "on", "30.5"; a light is said to be on or off.
std::string words_of(const nlohmann::json& value);
/// "each press of desk/io/2 switches io/13".
std::string in_words(const Link& link);

/// The property of this id; null: there is none.
const property::Property* find(const std::vector<property::Property>& properties, std::string_view id);
/// Why the target cannot be set so; empty: it can. Names the nearest property.
std::string target_fault(const Link& link, const std::vector<property::Property>& properties);
/// Why the source cannot be one of this link; empty: it can.
std::string source_fault(const Link& link, const std::vector<property::Property>& properties);

/// A link's ends, for circles: from "desk/io/2" to "lamp/io/13".
using Ends = std::pair<std::string, std::string>;
/// The circle that these make with one more, "lamp/io/13, desk/io/3, lamp/io/13"; empty: none.
std::string circle(const std::vector<Ends>& links, const Ends& added);

}  // namespace asip::links
