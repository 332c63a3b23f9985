// SPDX-License-Identifier: Apache-2.0
/// Queries and requests to forget, as JSON. A query goes to ROOT/registry/query (any registry) or
/// ROOT/registry/ID/query; its answer to the response topic, or to "reply_to"; events come on
/// ROOT/registry/ID/events.
#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "asip/bus/registry/label_selector.hpp"
#include "asip/bus/topics.hpp"
#include "asip/expected.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::bus {

enum class Find { kBoards, kServices, kHistory, kModels, kValues };
std::string_view to_string(Find find);

/// An empty filter lets everything pass; all given ones must hold, one with several values by any. With
/// Find::kServices the filters on boards hold for the service's board; with Find::kBoards `service`, `kind`
/// and `unit` ask for boards with such a service.
struct Query {
    Find find = Find::kBoards;  ///< of models only `kind`, `limit` and `cursor` are asked
    std::string board;          ///< board name; `*` any text, `?` any one character
    std::string service;        ///< service name, the same wildcards
    /// Model names ("distance"), else letters.
    std::vector<std::string> kind;
    std::vector<std::string> state;  ///< effective states of the board
    std::string chip;                ///< wildcards
    std::string sketch;              ///< wildcards
    std::string unit;                ///< a unit that some event or command of the service has ("cm")
    std::string capability;          ///< some pin can do this: "digital", "analog" or "pwm"
    LabelSelector labels;            ///< by labels of the board
    std::string sort = "name";  ///< "name", "state", "chip", "sketch", "last_seen"; "-" in front: descending
    std::size_t limit = 100;    ///< items a page; a registry gives at most kMaxPage
    std::string cursor;  ///< of the previous page's answer, with all else the same; empty: the first page
    bool count = false;  ///< give `total` even where it costs a scan
    bool full = false;   ///< boards with their whole description
    bool brief = false;  ///< boards only with what a table shows: Answer::brief instead of Answer::boards
    // A query of values has, beside `board` and `limit`, which is "points" there:
    std::string property{};  ///< its id; empty: the properties are listed of which values are kept
    text::WallTime from{};   ///< before `to`
    text::WallTime to{};

    static constexpr std::size_t kMaxPage = 1000;  ///< a larger limit is lowered to this
    /// For `full`: a registry has time for others between such pages.
    static constexpr std::size_t kMaxFullPage = 250;
    bool operator==(const Query&) const = default;
};

/// A board that is not alive leaves the catalogue, and its retained topics are emptied. `board` may hold
/// wildcards.
struct Forget {
    std::string board;
    bool dry_run = false;  ///< only answer which boards it would be

    bool operator==(const Forget&) const = default;
};

/// `id` and `reply_to` are for senders without MQTT 5.
struct RegistryRequest {
    std::variant<Query, Forget> what;
    std::string id;
    std::string reply_to;
};

/// Defaults are left out.
std::string encode(const RegistryRequest& request);
/// A null member is absent. Fails with the first fault and its place: "/limit: 0 is below 1". Unknown members
/// are refused, with the nearest known: a misspelt filter would let everything pass. Texts have at most 256
/// bytes, a cursor twice as many, lists 64 items, a selector LabelSelector::kMaxBytes.
Expected<std::variant<Query, Forget>> read_registry_request(const nlohmann::json& object);

/// Where requests to forget go: apart from queries, so that access rules can let a user ask and not forget.
inline std::string forget_topic(const Topics& topics, std::string_view registry = {}) {
    return topics.root() + "/registry/" + (registry.empty() ? "" : std::string(registry) + "/") + "forget";
}

}  // namespace asip::bus
