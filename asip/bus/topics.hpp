// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace asip::bus {

/// What a topic is for. "registry" kinds carry the registry's id instead of a board.
enum class TopicKind {
    kBoardNames,       ///< ROOT/servicebus: payload is a board name
    kServiceNames,     ///< ROOT/servicebus/BOARD: payload is a service name
    kState,            ///< ROOT/servicebus/BOARD/$state
    kDescription,      ///< ROOT/servicebus/BOARD/$description
    kStats,            ///< ROOT/servicebus/BOARD/$stats: what its agent counts
    kLog,              ///< ROOT/servicebus/BOARD/$log: what its agent reports to people
    kCommands,         ///< ROOT/servicebus/BOARD/$commands: commands and their senders
    kProperties,       ///< ROOT/servicebus/BOARD/$properties: what can be read and set, retained
    kDemand,           ///< ROOT/servicebus/BOARD/$demand/USER/CLIENT: how often CLIENT wants its values
    kProbe,            ///< ROOT/servicebus/$probe
    kBoardOut,         ///< ROOT/BOARD/out: raw lines
    kBoardIn,          ///< ROOT/BOARD/in: raw lines
    kValues,           ///< ROOT/BOARD/$values: how the board stands, retained
    kLinks,            ///< ROOT/BOARD/$links: its links, retained
    kLink,             ///< ROOT/BOARD/$link/USER/CLIENT: USER sets, changes or removes a link
    kStop,             ///< ROOT/BOARD/$stop
    kServiceOut,       ///< ROOT/BOARD/SERVICE/out
    kServiceIn,        ///< ROOT/BOARD/SERVICE/in
    kServiceError,     ///< ROOT/BOARD/SERVICE/error
    kServiceSet,       ///< ROOT/BOARD/SERVICE/set: left by agents of before, to be cleared
    kRegistryState,    ///< ROOT/registry/ID/$state
    kRegistryStats,    ///< ROOT/registry/ID/$stats
    kRegistryEvents,   ///< ROOT/registry/ID/events
    kRegistryQuery,    ///< ROOT/registry/ID/query: to one registry
    kAnyRegistryQuery  ///< ROOT/registry/query: to whichever answers
};

/// The names are views into the parsed topic; those that the kind lacks are empty.
struct TopicRef {
    TopicKind kind;
    std::string_view board;  ///< board name, or registry id
    std::string_view service;
    std::string_view demander{};  ///< kDemand, kLink: USER/CLIENT
    friend bool operator==(const TopicRef&, const TopicRef&) = default;
};

/// The topics below one root. Builders take valid names (model/names.hpp), or "+" for a subscription.
class Topics {
  public:
    /// Throws std::invalid_argument on an invalid root.
    explicit Topics(std::string root = "asip");

    /// One or more non-empty levels joined by `/`, at most 128 bytes, without wildcards, control characters
    /// or a leading `$`.
    static bool valid_root(std::string_view root);

    const std::string& root() const { return root_; }

    std::string board_names() const { return root_ + "/servicebus"; }
    std::string service_names(std::string_view board) const { return join("servicebus", board); }
    std::string state(std::string_view board) const { return join("servicebus", board, "$state"); }
    std::string description(std::string_view board) const {
        return join("servicebus", board, "$description");
    }
    std::string stats(std::string_view board) const { return join("servicebus", board, "$stats"); }
    std::string log(std::string_view board) const { return join("servicebus", board, "$log"); }
    std::string commands(std::string_view board) const { return join("servicebus", board, "$commands"); }
    std::string properties(std::string_view board) const { return join("servicebus", board, "$properties"); }
    /// `demander`: USER/CLIENT, or "+/+".
    std::string demand(std::string_view board, std::string_view demander) const;
    std::string probe() const { return root_ + "/servicebus/$probe"; }

    std::string board_out(std::string_view board) const { return join(board, "out"); }
    std::string board_in(std::string_view board) const { return join(board, "in"); }
    std::string values(std::string_view board) const { return join(board, "$values"); }
    std::string links(std::string_view board) const { return join(board, "$links"); }
    /// `who`: USER/CLIENT, or "+/+".
    std::string link(std::string_view board, std::string_view who) const { return join(board, "$link", who); }
    std::string stop(std::string_view board) const { return join(board, "$stop"); }
    std::string service_out(std::string_view board, std::string_view service) const {
        return join(board, service, "out");
    }
    std::string service_in(std::string_view board, std::string_view service) const {
        return join(board, service, "in");
    }
    std::string service_error(std::string_view board, std::string_view service) const {
        return join(board, service, "error");
    }
    std::string service_set(std::string_view board, std::string_view service) const {
        return join(board, service, "set");
    }

    std::string registry_state(std::string_view id) const { return join("registry", id, "$state"); }
    std::string registry_stats(std::string_view id) const { return join("registry", id, "$stats"); }
    std::string registry_events(std::string_view id) const { return join("registry", id, "events"); }
    std::string registry_query(std::string_view id) const { return join("registry", id, "query"); }
    std::string any_registry_query() const { return root_ + "/registry/query"; }

    /// Nothing: not below this root, none of these topics, or an invalid name in it. Any bytes may be given.
    std::optional<TopicRef> parse(std::string_view topic) const;
    /// In bytes: of a longer payload only that it is too long is read. The largest number: no bound.
    std::size_t longest_payload(std::string_view topic) const;

  private:
    std::string join(std::string_view a, std::string_view b) const;
    std::string join(std::string_view a, std::string_view b, std::string_view c) const;

    std::string root_;
};

/// `max_packet_size` of brokers that we configure: the longest messages are lists of properties, of 128 KiB.
/// The larger a message may be, the longer all others wait behind it and its copies.
inline constexpr std::size_t kBrokerPacketBytes = std::size_t{256} * 1024;

}  // namespace asip::bus
