// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "asip/property/property.hpp"
#include "asip/time.hpp"

namespace asip::property {

/// What a person does with a button.
enum class ButtonAct {
    kPress,    ///< at once
    kRelease,  //
    kHold,     ///< it has been pressed for Contact::kHold
    kDouble    ///< the second press within Contact::kDouble: behind that press
};
std::string_view to_text(ButtonAct act);
std::vector<std::string_view> button_words();
/// Nothing: there is no such word.
std::optional<ButtonAct> button_act(std::string_view word);

struct ButtonEvent {
    std::uint64_t number = 0;  ///< within the session, rising: a reader drops one that it has had
    ButtonAct act = ButtonAct::kPress;
    friend bool operator==(const ButtonEvent&, const ButtonEvent&) = default;
};

/// Its level is that of a contact, which bounces.
bool is_contact(const Property& property);
/// It has events.
bool is_button(const Property& property);

/// A report of its service is all that its value takes. What is counted together, set, or behind a contact
/// only the agent knows, and of a floating pin nothing is known.
bool is_reported(const Property& property);

/// A level behind a bouncing contact: a new one counts at once, then nothing until the contact was quiet for
/// kQuiet; then its present level. The rule of presses stands here, too. Pure.
class Contact {
  public:
    static constexpr Duration kQuiet = std::chrono::milliseconds(20);
    static constexpr Duration kHold = std::chrono::milliseconds(800);
    static constexpr Duration kDouble = std::chrono::milliseconds(400);
    static constexpr Duration kRecent = std::chrono::seconds(1);  ///< an event is told for so long

    /// `known`: the level that counts now, if any. True: the new one counts at once.
    bool heard(double level, std::optional<double> known, Time now);
    /// The level that counts since the contact is quiet; nothing: none is waited for.
    std::optional<double> settled(Time now);
    /// A new level counts. `next`: the number of the next event.
    void changed(bool pressed, Time now, std::uint64_t& next);
    /// True: it is held from now on.
    bool tick(Time now, std::uint64_t& next);
    std::optional<Time> next_deadline() const;
    std::vector<ButtonEvent> events(Time now) const;
    /// No press goes on that we know of.
    void let_go() { hold_at_.reset(); }

  private:
    struct Told {
        ButtonEvent event;
        Time when{};
    };
    static constexpr std::size_t kMaxTold = 16;
    void tell(ButtonAct act, Time now, std::uint64_t& next);

    std::optional<double> last_;  // while it bounces: what was heard last
    Time quiet_at_{};
    std::optional<Time> pressed_at_;  // that a second press may make a double one
    std::optional<Time> hold_at_;
    std::vector<Told> told_;
};

}  // namespace asip::property
