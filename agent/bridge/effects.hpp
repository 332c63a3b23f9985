// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "asip/member/announcer.hpp"
#include "asip/model/description.hpp"
#include "asip/model/labels.hpp"
#include "asip/session/action.hpp"

namespace asip::agent {

using member::Fatal;
using member::Notice;
using member::Publication;
using member::Publications;

/// A line for one point-to-point client, or for all of them.
struct ClientLine {
    std::string line;
    std::optional<session::ClientId> client;
};

/// Labels for the disk. `unknown_before`: the file could not be read, and may have been mended since.
struct LabelsToKeep {
    model::Labels labels;
    bool unknown_before = false;
};

/// A link with its memory, for the disk. An empty text deletes it.
struct LinkToKeep {
    std::string name, text;
    std::uint64_t ticket = 0;  ///< for Bridge::link_kept()
};

/// What the bridge wants done. The caller passes it empty, and performs all of it before the next call: in
/// order within a list, in any order across lists.
struct Effects : member::Announcements {
    std::vector<session::Action> link;  ///< Write and SetLineRate only
    std::vector<ClientLine> lines;      ///< for point-to-point clients
    std::vector<mqtt::Message> notes;   ///< of commands, for histories; behind the answers in `publish`, see
                                        ///< NotesToTell
    bool board_known = false;           ///< the board was identified (again): its name is known now
    bool name_claimed = false;          ///< the board's name is ours now: commands may come
    /// kLetGo: close the port and do not open it, until kTakeBack.
    enum class Port { kKeep, kLetGo, kTakeBack };
    Port port = Port::kKeep;  ///< whether the board's port changes hands
    /// With kLetGo: firmware to load; then Bridge::loading() and Bridge::loaded() follow.
    struct Load {
        std::string path;
        std::string firmware;
        std::string board;  ///< as in bus::PortRequest
    };
    std::optional<Load> load;
    std::optional<LabelsToKeep> keep_labels;  ///< to be written to the disk; then Bridge::labels_kept()
    std::vector<LinkToKeep> keep_links;       ///< in order
    /// The stop to store; an empty inner optional deletes the file.
    std::optional<std::optional<model::StopInfo>> keep_stop;
    /// The board was told to stop: after keep_stop, and before anything else, call Bridge::refuse_waiting().
    bool stopped = false;
    bool begin_anew = false;   ///< another board is at the port: all of this is over, and begins again
    bool reopen_link = false;  ///< open, but the board behind it is gone: a connection may be dead
};

}  // namespace asip::agent
