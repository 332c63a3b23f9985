// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/model/description.hpp"
#include "asip/protocol/pin.hpp"
#include "cli/environment.hpp"
#include "cli/find/chosen_boards.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct PinOptions {
    std::string board;
    std::string pin;     ///< empty: all of them, as the board reports them
    std::string word;    ///< empty: read it
    std::string duty{};  ///< behind `pwm`
    OutputOptions output{};
};

/// What is known of a pin.
struct PinReading {
    protocol::PinMode mode = protocol::PinMode::kInvalid;
    std::optional<int> value{};
};
/// `high`, `low`, the number of an analog value, or nothing.
std::string value_text(const PinReading& reading);

/// The modes in a board's answer to the question for them, by pin.
Outcome<std::vector<protocol::PinMode>> modes_of(const std::string& answer);

/// `asipctl pin`: reads or sets one pin of a board in words.
int run_pin(PinOptions options, Environment& environment);

/// `13`, `D13`, or `A0` by the board's analog map. Fails with kExitUsage.
Outcome<int> parse_pin(std::string_view text, const model::PinsInfo& pins);

/// The same, or the name that was given to a pin (asipctl label BOARD pin.13=NAME).
Outcome<int> find_pin(std::string_view text, const model::Description& description);

/// What to put behind the board's error when a pin belongs to another service than io: `; pin 9 belongs to
/// the service desk/servo: ...`. Empty when it does not, or when the board does not report owners.
std::string why_taken(const model::Description& description, int pin);

/// What a word asks for.
struct PinAction {
    enum class Kind { kMode, kWrite, kPwm, kToggle };
    Kind kind = Kind::kMode;
    protocol::PinMode mode = protocol::PinMode::kInput;  ///< that the pin must have
    int value = 0;                                       ///< level or duty
};
/// A mode's name, `high`, `low`, `on`, `off`, `toggle`, or 0 to 255 for PWM. Fails with kExitUsage and the
/// nearest word.
Outcome<PinAction> parse_pin_word(std::string_view word);

/// The requests to the io service, as its topic takes them, that bring it about for a pin that is in `mode`
/// now.
std::vector<std::string> pin_requests(int pin, const PinAction& action,
                                      std::optional<protocol::PinMode> mode);

}  // namespace asip::cli
