// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/protocol/pin.hpp"

namespace asip::session {

/// `I,P,pin,mode`
struct ModeRequest {
    int pin;
    int mode;
};
std::optional<ModeRequest> parse_mode_request(std::string_view line);

/// What is set again after a board restarted: pin modes, levels of output pins, and periods of events. Never
/// the duty of a pin, nor what a service does: a motor must not start because a board restarted.
class SettingsMemory {
  public:
    /// One request of restore().
    struct Setting {
        std::string line;
        std::string next{};  ///< what has to follow in the same write
    };

    /// `#,R` forgets everything: its sender wanted a fresh board. `keeps_level`: an output that
    /// is made one once more stays at its level; otherwise it is low then.
    void executed(std::string_view line, bool keeps_level);
    /// It may have been executed: the level of its pin is not known, and is not set again.
    void in_doubt(std::string_view line);
    /// A request that was taken for executed and then refused.
    void refused(std::string_view line);

    static bool is_setting(std::string_view line);

    bool empty() const { return modes_.empty() && periods_.empty(); }
    /// Requests that set everything again, modes first, by pin. The level is set before the mode where
    /// `present`, the modes that the pins have, allows that, and behind it in any case. `present` is empty
    /// where a board clears the level by the mode. Without `outputs` no pin begins to drive.
    std::vector<Setting> restore(const std::vector<protocol::PinMode>& present, bool outputs) const;
    /// Requests that write the levels of output pins.
    std::vector<std::string> levels() const;
    std::optional<unsigned> period(char service) const;

  private:
    void mode_executed(const ModeRequest& mode, std::string_view line, bool keeps_level);
    bool is_output(int pin) const;

    std::map<int, std::string> modes_;  // pin -> line
    std::map<int, bool> levels_;        // pin -> what was last written
    std::map<char, unsigned> periods_;  // service -> ms
};

}  // namespace asip::session
