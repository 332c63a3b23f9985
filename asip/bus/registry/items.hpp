// SPDX-License-Identifier: Apache-2.0
/// What answers and change events are made of. Their `state` is effective: reported AND the lease not run
/// out.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/model/labels.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::bus {

// The rows of an answer to a brief query: boards with only what a table shows, for catalogues of thousands.
// On the wire each is an array, read by position; elements behind those known here are passed over:
//     [BOARD, STATE, AGE, CHIP, SKETCH, SERVICES, CONFLICT, REASON, FOR]
// SKETCH is that of firmware_text().
// CONFLICT may be missing: false. So may both REASON (of the state) and FOR (seconds it has been in it).

/// Members as in BoardItem. The texts belong to its BriefRows, or to the caller.
struct BriefBoard {
    std::string_view board;
    std::string_view state;  ///< effective
    double age = 0;          ///< seconds since anything was heard from it; negative: unknown
    std::string_view chip;
    std::string_view sketch;
    std::string_view services;  ///< names with a blank between them
    bool conflict = false;
    std::string_view reason{};  ///< of the state; empty: nothing to explain, or not known
    double state_age = -1;      ///< where there is a reason: seconds in the state; negative: unknown

    bool operator==(const BriefBoard&) const = default;
    /// Nothing but name, state and age differs within the same BriefRows, and no state has a reason; false is
    /// a maybe.
    bool like(const BriefBoard& other) const;
};

/// Copies share the texts: all belong to one thread.
class BriefRows {
  public:
    /// Copies the texts; those of the row before are kept once, as most boards of a fleet are alike.
    void add(const BriefBoard& row);
    void reserve(std::size_t rows) { rows_.reserve(rows); }

    /// May be reordered, and thinned out.
    std::vector<BriefBoard>& rows() { return rows_; }
    const std::vector<BriefBoard>& rows() const { return rows_; }
    std::size_t size() const { return rows_.size(); }
    bool empty() const { return rows_.empty(); }

    bool operator==(const BriefRows& other) const { return rows_ == other.rows_; }

  private:
    std::string_view kept(std::string_view text, std::string_view above);

    std::vector<BriefBoard> rows_;
    std::shared_ptr<std::pmr::monotonic_buffer_resource> texts_;
};

/// Appends an array. Bytes that are not UTF-8 become U+FFFD; ages are cut to milliseconds.
void append_brief_rows(std::string& text, const BriefRows& boards);

/// Fails with the number of the first bad row. Never more rows than bytes / 14.
Expected<BriefRows> read_brief_rows(std::string_view rows);

struct BriefSplit {
    std::string envelope;  ///< the answer without its member "items"
    Expected<BriefRows> rows;
};

/// Nothing: not well-formed, or no brief answer.
std::optional<BriefSplit> split_brief(std::string_view payload);

struct ServiceItem {
    std::string board;
    std::string state;  ///< effective state of the board
    std::string name;   ///< on the bus
    std::string kind;   ///< model name, or the letter where there is no model
    std::string model;  ///< as the description refers to it ("distance@1"); empty: none, or carried in full
    std::string id;     ///< the letter; empty for a service of which only the name is published
    std::string title;
    std::optional<int> count;   ///< elements
    std::optional<int> period;  ///< of its auto-event, milliseconds
    std::string label{};        ///< its friendly name

    bool operator==(const ServiceItem&) const = default;
};

/// Two living agents claim one board name.
struct Conflict {
    std::string holder;       ///< session whose description is the catalogue's
    std::string other;        ///< session that is refused
    std::string other_agent;  ///< what is known of the other's agent: host and client, for a person

    bool operator==(const Conflict&) const = default;
};

/// What is unknown is empty.
struct BoardItem {
    std::string board;
    std::string state;        ///< effective
    std::string reason;       ///< why, a word of model::StateReason; empty: nothing to explain, or not known
    std::string reported;     ///< the last state that the agent or its will published
    bool names_only = false;  ///< takes part with the published names only: no description
    std::string session;      ///< of its description
    std::uint64_t seq = 0;    ///< of its description
    double lease = 0;         ///< seconds
    double age = 0;           ///< seconds since anything was heard from it, when this was written; -1: never
    text::WallTime first_seen{};
    text::WallTime last_seen{};
    text::WallTime since{};  ///< when it came into `state`; empty: not known
    double state_age = -1;   ///< seconds since then, when this was written; -1: not known
    std::string chip;
    std::string sketch;
    std::string version;    ///< of the firmware library in the sketch: "0.2"
    std::string available;  ///< the newer one that its agent would load
    std::string protocol;   ///< "0.4"
    std::string agent;      ///< host and client of its agent, for a person
    std::string link;       ///< kind and path of the link, for a person
    model::Labels labels;   ///< and friendly names
    std::optional<Conflict> conflict;
    /// Their `board` and `state` are filled when parsed.
    std::vector<ServiceItem> services;
    /// The whole $description as last received, where the query asked for it.
    std::string description;

    bool operator==(const BoardItem&) const = default;
};

/// A change of state, or a command, from a registry's history.
struct HistoryItem {
    std::string board;
    text::WallTime at{};
    /// "added", "state", "description", "conflict", "resolved", "forgotten"; "command", "stop", "undone"
    std::string what;
    std::string state;   ///< effective state after it; empty for a command
    std::string was;     ///< before it; empty for other than "state"
    std::string reason;  ///< a word of model::StateReason; of a command: why it is not "ok", as Reply::reason
    // With a command only:
    std::string by{};       ///< the name that its sender gave
    std::string service{};  ///< empty: raw lines, or the whole board
    std::string request{};  ///< its beginning
    std::string status{};   ///< Reply::status in words; "sent": its sender wanted no answer
    int count = 0;          ///< of commands that differ in their arguments alone, within a second; 0: one

    bool is_command() const { return !by.empty(); }

    bool operator==(const HistoryItem&) const = default;
};

/// How a property was from `at` until the next point. On the wire an array: [AT,MEAN,MIN,MAX], [AT,VALUE]
/// where all three are the same, [AT,null] where a gap begins: nothing is known, or the board is not there.
struct ValuePoint {
    text::WallTime at{};
    bool known = false;
    double mean = 0, min = 0, max = 0;

    bool operator==(const ValuePoint&) const = default;
};

/// A property of which a registry keeps values.
struct KeptProperty {
    std::string board;
    std::string property;

    bool operator==(const KeptProperty&) const = default;
};

/// For a table: "AsipServices 0.2", "AsipServices 0.2, out of date".
std::string firmware_text(const std::string& sketch, const std::string& version,
                          const std::string& available);
BriefRows brief_of(std::span<const BoardItem> boards);

/// For "items" of an answer.
nlohmann::json to_json(const BoardItem& item);
nlohmann::json to_json(const ServiceItem& item);
nlohmann::json to_json(const HistoryItem& item);
/// Appends the same as text.
void append_json(std::string& out, const BoardItem& item);
void append_json(std::string& out, const ServiceItem& item);
void append_json(std::string& out, const HistoryItem& item);
void append_json(std::string& out, const ValuePoint& point);
void append_json(std::string& out, const KeptProperty& item);

/// A missing or mistyped member is empty.
BoardItem read_board_item(const nlohmann::json& object);
ServiceItem read_service_item(const nlohmann::json& object);
HistoryItem read_history_item(const nlohmann::json& object);
/// Nothing: it is no point.
std::optional<ValuePoint> read_value_point(const nlohmann::json& array);
KeptProperty read_kept_property(const nlohmann::json& object);

}  // namespace asip::bus
