// SPDX-License-Identifier: Apache-2.0
/// What is sent to a registry: queries and requests to forget. Pure: JSON in and out, no connection. A query
/// goes to ROOT/registry/query (any registry) or ROOT/registry/ID/query; its answer to the response topic of
/// the message, or to "reply_to" in the query; events come on ROOT/registry/ID/events.
///
/// Board states on this wire are the words of the service bus: "online", "offline", "lost", "sleeping",
/// "updating". They are effective states: what was reported AND the lease not run out.
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

namespace asip::bus {

/// What a query lists.
enum class Find { kBoards, kServices, kHistory, kModels };
/// "boards", "services", "history", "models"
std::string_view to_string(Find find);

/// A question. Every filter left empty lets everything pass; those given must all hold; a filter with several
/// values holds if one of them does. For Find::kServices the filters on boards hold for the board the service
/// is on; for Find::kBoards `service`, `kind` and `unit` ask for boards with such a service.
struct Query {
    Find find = Find::kBoards;  ///< of models only `kind`, `limit` and `cursor` are asked
    std::string board;          ///< board name; `*` any text, `?` any one character
    std::string service;        ///< service name, the same wildcards
    /// Model names ("distance"); a service without a model has its letter as kind.
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

    static constexpr std::size_t kMaxPage = 1000;  ///< a larger limit is lowered to this
    /// The same for `full`: a registry that answers one such page after the other has time for others
    /// between.
    static constexpr std::size_t kMaxFullPage = 250;
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
/// What the object of a request's envelope asks for. A member that is null counts as absent. Fails with the
/// first fault and its place: "/limit: 0 is below 1". Unknown members are refused, with the nearest that is
/// known: a filter that is misspelt would let everything pass, and a forget that is misspelt would forget.
/// Texts have at most 256 bytes, lists at most 64 items, a selector of labels
/// LabelSelector::kMaxBytes.
Expected<std::variant<Query, Forget>> read_registry_request(const nlohmann::json& object);

/// Where a registry, or each of them, is asked to forget a board: another topic than for queries, so that the
/// broker's access rules can let a user ask and not forget.
inline std::string forget_topic(const Topics& topics, std::string_view registry = {}) {
    return topics.root() + "/registry/" + (registry.empty() ? "" : std::string(registry) + "/") + "forget";
}

}  // namespace asip::bus
