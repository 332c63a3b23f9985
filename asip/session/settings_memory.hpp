// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace asip::session {

/// What is set again after a board restarted: pin modes and periods of events. Never output values: a relay
/// must not click because a board rebooted.
class SettingsMemory {
  public:
    /// `#,R` forgets everything: its sender wanted a fresh board.
    void executed(std::string_view line);
    /// A request that was taken for executed and then refused.
    void refused(std::string_view line);

    static bool is_setting(std::string_view line);

    bool empty() const { return modes_.empty() && periods_.empty(); }
    /// Requests that set everything again: modes first, by pin.
    std::vector<std::string> restore() const;
    std::optional<unsigned> period(char service) const;

  private:
    std::map<int, std::string> modes_;  // pin -> line
    std::map<char, unsigned> periods_;  // service -> ms
};

/// `I,P,pin,mode`
struct ModeRequest {
    int pin;
    int mode;
};
std::optional<ModeRequest> parse_mode_request(std::string_view line);

}  // namespace asip::session
