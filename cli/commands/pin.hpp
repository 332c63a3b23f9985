// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/model/description.hpp"
#include "asip/protocol/pin.hpp"
#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct PinOptions {
    std::string board;
    std::string pin;     ///< empty: all of them, as the board reports them
    std::string word;    ///< empty: read it
    std::string duty{};  ///< behind `pwm`
    OutputOptions output{};
};

struct PinReading {
    protocol::PinMode mode = protocol::PinMode::kInvalid;
    std::optional<int> value{};
};
/// `high`, `low`, an analog number, or nothing.
std::string value_text(const PinReading& reading);

/// By pin.
Outcome<std::vector<protocol::PinMode>> modes_of(const std::string& answer);

int run_pin(PinOptions options, Environment& environment);

/// `13`, `D13`, or `A0` by the analog map. Fails with kExitUsage.
Outcome<int> parse_pin(std::string_view text, const model::PinsInfo& pins);

/// Or a name (asipctl label BOARD pin.13=NAME).
Outcome<int> find_pin(std::string_view text, const model::Description& description);

/// `; pin 9 belongs to the service desk/servo: ...`, behind the board's error; empty: it belongs to io, or
/// owners are not known.
std::string why_taken(const model::Description& description, int pin);

struct PinAction {
    enum class Kind { kMode, kWrite, kPwm, kToggle };
    Kind kind = Kind::kMode;
    protocol::PinMode mode = protocol::PinMode::kInput;  ///< that the pin must have
    int value = 0;                                       ///< level or duty
};
/// A mode's name, `high`, `low`, `on`, `off`, `toggle`, or 0 to 255 for PWM. Fails with kExitUsage and the
/// nearest word.
Outcome<PinAction> parse_pin_word(std::string_view word);

/// For the io service's topic, for a pin in `mode`.
std::vector<std::string> pin_requests(int pin, const PinAction& action,
                                      std::optional<protocol::PinMode> mode);

}  // namespace asip::cli
