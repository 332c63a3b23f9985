// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::gateway {

/// What a client may do at most; each role may all that the ones before it may, but that a kiosk is shown
/// what its token names only.
enum class Role {
    kNone,      ///< nothing
    kKiosk,     ///< reads what its patterns name, and may be shown in other pages
    kViewer,    ///< reads
    kOperator,  ///< also sends commands
    kAdmin,     ///< also forgets boards
};
std::string_view to_string(Role role);

/// What a client may do, and under which name it is logged. A value: whether it is still in force is
/// Gate::still_admitted()'s to say.
struct Rights {
    Role role = Role::kNone;
    bool raw = false;  ///< may send raw lines, which reach every service; an admin may anyway
    std::string name;
    std::vector<std::string> boards;      ///< patterns (`*` any text, `?` any one character); empty: all
    std::vector<std::string> services;    ///< patterns of services, on every board that is seen; empty: all
    std::vector<std::string> frames;      ///< kKiosk: origins whose pages may show it
    std::string dashboard;                ///< kKiosk: sees this dashboard and nothing else; empty: no such
    bool control = false;                 ///< may use the switches, sliders and stops of its dashboard
    std::optional<text::WallTime> until;  ///< when they end; nothing: never
    /// The hash of the token that gives them; empty: none does. Another token with the same name and the same
    /// rights gives other rights.
    std::string token_hash;
    /// A dashboard's link has its maker, a pupil the teacher; and mark() of those rights.
    std::string maker, maker_mark;
    std::string lesson;  ///< of a pupil: which one; what a pupil does ends with it
    std::string place;   ///< of a pupil who may lend a board: that is "lent-" and this; empty: may not

    bool may_read() const { return role != Role::kNone; }
    bool may_command() const { return role >= Role::kOperator; }
    /// A stop, a resume and a raw line reach every service of a board, and a board is forgotten as a whole:
    /// none of them is for rights on some services only.
    bool may_stop() const { return may_command() && services.empty(); }
    /// A pupil does not: the teacher's stop holds.
    bool may_resume() const { return may_stop() && lesson.empty(); }
    /// Labels and friendly names; those of a service may be read by every client that sees the board. They,
    /// links and firmware would outlast a lesson.
    bool may_label() const { return may_stop() && lesson.empty(); }
    bool may_send_raw() const { return may_stop() && (raw || role == Role::kAdmin); }
    bool may_forget() const { return role == Role::kAdmin && services.empty(); }
    /// A board in its browser's computer. It sees what all browsers lend, so that it sees its own; a pupil
    /// has a place for its own.
    bool may_lend() const;
    /// Make, change, share and remove dashboards. A shared dashboard gives its viewers rights of its editor.
    bool may_arrange() const { return may_command() && !limited(); }
    /// By the patterns alone: whether anything may be read is the role's to say.
    bool sees_board(std::string_view board) const;
    bool sees_service(std::string_view board, std::string_view service) const;
    /// Some boards or services are hidden from it, now or once they are there.
    bool limited() const { return !boards.empty() || !services.empty() || !dashboard.empty(); }
    /// Tells the token that gives them from others of its name, and nothing of it; empty: none does.
    std::string mark() const;
    /// A dashboard's link gives them; no token of the file has such a name.
    bool of_link() const { return lesson.empty() && name.find('@') != std::string::npos; }
    /// Names what is seen: equal for rights that see the same by the same patterns; empty: everything.
    std::string seen() const;
    friend bool operator==(const Rights&, const Rights&) = default;
};

/// "viewer", "operator", "operator+raw", "admin", "kiosk": rights on every board, without a name. Fails with
/// a sentence that names the roles and the nearest one.
Expected<Rights> parse_role(std::string_view text);

}  // namespace asip::gateway
