// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::gateway {

enum class Role {
    kNone,
    kKiosk,     ///< reads what its patterns name, and may be shown in other pages
    kViewer,    ///< reads
    kOperator,  ///< also sends commands
    kAdmin,     ///< also forgets boards
};
std::string_view to_string(Role role);

/// What somebody may do, and under which name it is logged.
struct Rights {
    Role role = Role::kNone;
    bool raw = false;  ///< may send raw lines, which reach every service; an admin may anyway
    std::string name;
    std::vector<std::string> boards;    ///< patterns; empty: all
    std::vector<std::string> services;  ///< patterns; empty: all
    std::vector<std::string> frames;    ///< kKiosk: origins whose pages may show it
    std::optional<text::WallTime> until;

    bool may_read() const { return role != Role::kNone; }
    bool may_command() const { return role >= Role::kOperator; }
    bool may_send_raw() const {
        return role >= Role::kOperator && (raw || role == Role::kAdmin) && services.empty();
    }
    bool may_forget() const { return role == Role::kAdmin; }
    bool sees_board(std::string_view board) const;
    bool sees_service(std::string_view board, std::string_view service) const;
    bool limited() const { return !boards.empty() || !services.empty(); }
    friend bool operator==(const Rights&, const Rights&) = default;
};

/// "viewer", "operator", "operator+raw", "admin", "kiosk"
Expected<Rights> parse_role(std::string_view text);

}  // namespace asip::gateway
