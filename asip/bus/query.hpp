#pragma once
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "asip/bus/brief.hpp"
#include "asip/expected.hpp"
#include "asip/text/wall_time.hpp"

/// What is said between a registry and those who ask it: queries, their answers and change events. Pure: JSON
/// in and out, no connection. A query goes to ROOT/registry/query (any registry) or ROOT/registry/ID/query;
/// its answer to the response topic of the message, or to "reply_to" in the query; events come on
/// ROOT/registry/ID/events.
///
/// Board states on this wire are the words of the service bus: "online", "offline", "lost", "sleeping",
/// "updating". They are effective states: what was said AND the lease not run out.
namespace asip::bus {

enum class Find { kBoards, kServices, kHistory };

/// A question. Every filter left empty lets everything pass; those given must all hold; a filter with several
/// values holds if one of them does. For Find::kServices the filters on boards hold for the board the service
/// is on; for Find::kBoards `service`, `kind` and `unit` ask for boards with such a service.
struct Query {
    Find find = Find::kBoards;
    std::string board;    ///< board name; `*` any text, `?` any one character
    std::string service;  ///< service name, the same wildcards
    std::vector<std::string>
        kind;  ///< model names ("distance"); a service without a model has its letter as kind
    std::vector<std::string> state;  ///< effective states of the board
    std::string chip;                ///< wildcards
    std::string sketch;              ///< wildcards
    std::string unit;                ///< a unit some field of the service's model has ("cm")
    std::string capability;          ///< some pin can do this: "digital", "analog" or "pwm"
    std::string sort = "name";  ///< "name", "state", "chip", "sketch", "last_seen"; "-" in front: descending
    std::size_t limit = 100;    ///< items a page; a registry gives at most kMaxPage
    std::string cursor;  ///< of the previous page's answer, with all else the same; empty: the first page
    bool count = false;  ///< give `total` even where it costs a scan
    bool full = false;   ///< boards with their whole description
    bool brief = false;  ///< boards only with what a table shows: Answer::brief instead of Answer::boards

    static constexpr std::size_t kMaxPage = 1000;
    bool operator==(const Query&) const = default;
};

/// Forget a board that is not alive: it leaves the catalogue and its retained topics are emptied. `board` may
/// hold wildcards; boards that are alive are never forgotten.
struct Forget {
    std::string board;
    bool dry_run = false;  ///< only answer which boards it would be

    bool operator==(const Forget&) const = default;
};

/// A message on a query topic. `id` and `reply_to` are for senders without MQTT 5 response topic and
/// correlation data.
struct RegistryRequest {
    std::variant<Query, Forget> what;
    std::string id;
    std::string reply_to;
};

/// The payload for a request. Members at their defaults are left out.
std::string encode(const RegistryRequest& request);
/// Error: a sentence that names the member that is wrong. Unknown members are ignored; unknown values are
/// not.
Expected<RegistryRequest> parse_registry_request(std::string_view payload);

struct ServiceItem {
    std::string board;
    std::string state;  ///< effective state of the board
    std::string name;   ///< on the bus
    std::string kind;   ///< model name, or the letter where there is no model
    std::string model;  ///< as the description refers to it ("distance@1"); empty: none, or carried in full
    std::string id;     ///< the letter; empty for a service announced by name only
    std::string title;
    std::optional<int> count;   ///< elements
    std::optional<int> period;  ///< of its auto-event, milliseconds

    bool operator==(const ServiceItem&) const = default;
};

/// Two agents that both live claim one board name.
struct Conflict {
    std::string holder;       ///< session whose description is the catalogue's
    std::string other;        ///< session that is refused
    std::string other_agent;  ///< what is known of the other's agent: host and client, for a person

    bool operator==(const Conflict&) const = default;
};

struct BoardItem {
    std::string board;
    std::string state;     ///< effective
    std::string said;      ///< what was last said, by the agent or its will
    bool by_name = false;  ///< takes part with the published names only: no description
    std::string session;
    std::uint64_t seq = 0;
    double lease = 0;  ///< seconds
    double age = 0;    ///< seconds since anything was heard from it, when this was written
    text::WallTime first_seen{};
    text::WallTime last_seen{};
    text::WallTime since{};  ///< when it came into `state`
    std::string chip;
    std::string sketch;
    std::string protocol;  ///< "0.4"
    std::string agent;     ///< host and client of its agent, for a person
    std::string link;      ///< kind and path of the link, for a person
    std::optional<Conflict> conflict;
    std::vector<ServiceItem>
        services;  ///< their `board` and `state` are left out on the wire and filled when parsed
    /// JSON text of the whole $description as last received, where the query asked for it; else empty.
    std::string description;

    bool operator==(const BoardItem&) const = default;
};

/// One change of state that a registry with a history has kept.
struct HistoryItem {
    std::string board;
    text::WallTime at{};
    std::string what;    ///< "added", "state", "description", "conflict", "resolved", "forgotten"
    std::string state;   ///< effective state after it
    std::string was;     ///< before it; empty for other than "state"
    std::string reason;  ///< as ChangeEvent::reason

    bool operator==(const HistoryItem&) const = default;
};

/// An answer to a query or a forget. An error has `refused` set and nothing else but `id` and `registry`.
struct Answer {
    std::string id;         ///< of the request
    std::string registry;   ///< who answers
    std::string epoch;      ///< differs each time a registry starts counting anew
    std::uint64_t seq = 0;  ///< the items hold after exactly the change events of `epoch` up to this number
    bool settling = false;  ///< the registry is still reading what the broker retains: more will come
    std::optional<std::size_t> total;  ///< all matches, where asked for or known anyway
    std::vector<BoardItem> boards;
    /// Set: the answer is to a brief query, and `boards` is empty. A registry that does not know brief
    /// queries answers with `boards`.
    std::optional<std::vector<BriefBoard>> brief;
    std::vector<ServiceItem> services;
    std::vector<HistoryItem> history;
    std::vector<std::string> forgotten;  ///< board names
    std::string cursor;                  ///< for the next page; empty: this was the last
    std::string refused;  ///< reason: "invalid", "alive", "unknown-board", "no-history", "too-many"
    std::string error;    ///< the reason in a sentence

    bool operator==(const Answer&) const = default;
};

/// A board as a brief query would tell of it.
BriefBoard brief_of(const BoardItem& board);

std::string encode(const Answer& answer);
Expected<Answer> parse_answer(std::string_view payload);

/// A change of the catalogue of registry `registry`. Within an epoch events carry consecutive numbers.
struct ChangeEvent {
    enum class Kind {
        kAdded,        ///< board known for the first time
        kState,        ///< effective state: `was` -> board.state
        kDescription,  ///< services, chip, pins, ...: anything of the description but seq
        kConflict,     ///< board.conflict appeared or changed
        kResolved,     ///< conflict over
        kForgotten,    ///< board left the catalogue; only `board.board` holds anything
        kReset,        ///< no board: more changed than is told one by one; take a new snapshot
    };
    Kind kind = Kind::kReset;
    std::string registry;
    std::string epoch;
    std::uint64_t seq = 0;
    text::WallTime at{};
    BoardItem board;  ///< as it is after the change (without description)
    std::string was;  ///< kState: effective state before
    std::string
        reason;  ///< kState: "said", "will", "lease", "announced", "retained"; else as fits, may be empty

    bool operator==(const ChangeEvent&) const = default;
};

/// "added", "state", "description", "conflict", "resolved", "forgotten", "reset"
std::string_view to_string(ChangeEvent::Kind kind);

std::string encode(const ChangeEvent& event);
Expected<ChangeEvent> parse_change_event(std::string_view payload);

/// For readers that print items as JSON: what stands in "items" of an answer.
nlohmann::json to_json(const BoardItem& item);
nlohmann::json to_json(const ServiceItem& item, bool with_board = true);
nlohmann::json to_json(const HistoryItem& item);

/// `text` against a pattern with `*` and `?`; an empty pattern matches everything.
bool matches_pattern(std::string_view pattern, std::string_view text);

}  // namespace asip::bus
