// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace asip::session {

/// What clients had set on a board and what has to be set again after it restarted: pin modes and auto-event
/// periods. Output values are never in here: a relay must not click because a board rebooted.
class SettingsMemory {
  public:
    /// A request the board executed. `#,R` forgets everything: its sender wanted a fresh board.
    void executed(std::string_view line);
    /// A request that was taken for executed and then refused.
    void refused(std::string_view line);

    /// Whether a request is one of those that are remembered.
    static bool is_setting(std::string_view line);

    bool empty() const { return modes_.empty() && periods_.empty(); }
    /// Request lines that set everything again: modes first, by pin.
    std::vector<std::string> restore() const;
    std::optional<unsigned> period(char service) const;

  private:
    std::map<int, std::string> modes_;  // pin -> line
    std::map<char, unsigned> periods_;  // service -> ms
};

/// Pin and mode of an `I,P,pin,mode` request.
struct ModeRequest {
    int pin;
    int mode;
};
std::optional<ModeRequest> parse_mode_request(std::string_view line);

}  // namespace asip::session
