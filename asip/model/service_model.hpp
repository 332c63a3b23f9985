// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/expected.hpp"

namespace asip::model {

/// What one value is, in JSON and on the wire.
enum class ValueType {
    kInteger,
    kNumber,  ///< a decimal fraction is allowed
    kText,    ///< printable ASCII
    kColor,   ///< an integer r<<16|g<<8|b; commands also take "#rrggbb"
    /// Arguments only: the number of items of the list named by Field::of. Computed, never given by the
    /// caller.
    kCount,
    /// Arguments only: one or more items, each with the fields in Field::items.
    kList,
};
/// The word in a model's file: "integer", "number", "text", "color", "count", "list".
std::string_view to_text(ValueType type);

/// A field of an event or an argument of a command.
struct Field {
    std::string name;
    ValueType type = ValueType::kInteger;
    std::string title;          ///< for a person; may be empty
    std::string unit;           ///< of the value as it is on the bus: "cm"; may be empty
    std::optional<double> min;  ///< of a number, included
    std::optional<double> max;
    std::optional<std::size_t> max_length;                    ///< of a text, in bytes; of a list, in items
    std::vector<std::pair<std::string, std::int64_t>> names;  ///< numbers that have a name: {"input", 1}
    std::string of;                                           ///< kCount: the name of the list
    std::vector<Field> items;  ///< kList: the fields of one item, joined by ':' on the wire
    bool braces = false;       ///< kList: `{a,b}` on the wire instead of `a,b`
};

/// How the body of an event is laid out on the wire, and the JSON value that it becomes.
enum class EventShape {
    kPerElement,  ///< COUNT,{...}: one item for each element -> array
    kOnce,        ///< COUNT,{...}: item i is field i -> object
    kPlain,       ///< a,b: no count and no braces -> object, or the value where there is one field
    kPorts,       ///< PORT,HEXMASK or COUNT,{PORT:HEXMASK,...} -> {"PIN":0|1}, through the port map
    kPortMap,     ///< COUNT,{PORT:HEXMASK} -> [{"port":,"mask":}]
    kMap,         ///< COUNT,{KEY:VALUE} -> {"KEY":VALUE}; without keys, the position is the key
};

/// An event that a service sends.
struct EventModel {
    char tag = 0;
    std::string name;   ///< the member that carries it in JSON
    std::string title;  ///< for a person
    EventShape shape = EventShape::kPerElement;
    std::vector<Field> fields;
};

/// An argument of a safe form: the one that was given in this place, or a number.
struct SafeArgument {
    std::optional<std::size_t> given;  ///< place among the arguments that the caller gives
    double number = 0;
};

/// What undoes a command.
struct SafeForm {
    std::string command;  ///< name of the command that is sent instead; may be the same
    std::vector<SafeArgument> arguments;
};

/// A command that a service executes.
struct CommandModel {
    char tag = 0;
    std::string name;
    std::string title;  ///< for a person
    std::vector<Field> args;
    char answer = 0;  ///< tag of the event that answers it; 0: none
    /// How long after its execution that event may come; none: the model does not say.
    std::optional<std::chrono::milliseconds> answer_time;
    std::optional<SafeForm> safe;  ///< none: nothing undoes it
};

/// The arguments that a caller gives: all but the counts, in order. Valid as long as `command`.
std::vector<const Field*> given_arguments(const CommandModel& command);

class ModelHints;

/// One kind of service: the contents of one file of services/. Not changed once loaded, so that pointers to
/// its events and commands stay valid as long as it.
struct ServiceModel {
    std::string name;  ///< "distance"
    int version = 1;
    char id = 0;                     ///< its letter, A to Z
    std::vector<std::string> match;  ///< friendly names of 0.4 boards; see matches()
    std::string title;               ///< for a person
    std::string element;             ///< what one element is called: "sensor"; may be empty
    std::vector<EventModel> events;
    std::vector<CommandModel> commands;
    std::vector<std::string> safe;  ///< request lines that bring the whole service into its safe state: "M,S"
    std::shared_ptr<const ModelHints> hints;  ///< what its values mean; never null in a model that was read
    std::string source;                       ///< its JSON text, compact, without examples
    std::string example_source;               ///< the array "examples", compact; empty where there is none

    /// How a description refers to it: "distance@1".
    std::string ref() const;

    // Each returns null where there is none. Of several commands with one tag, the first.
    const EventModel* event(char tag) const;
    const EventModel* event_named(std::string_view event_name) const;
    const CommandModel* command(std::string_view command_name) const;
    const CommandModel* command_with_tag(char tag) const;

    /// Whether it describes a service with this letter and, where the board gave one, this friendly name.
    /// Case and everything except letters and digits are ignored; a name matches when it contains a word of
    /// `match` ("ASIP Distance" and "Distance" both match "Distance").
    bool matches(char letter, std::string_view friendly_name) const;
};

/// From a model's JSON, which anyone may have written. Fails with the first fault and its place,
/// "/commands/report/args/0/type: ...", when it breaks services/schema.json, holds control characters outside
/// its examples, or contradicts itself (two commands with one tag are allowed, two events with one tag or
/// name are not).
Expected<ServiceModel> service_model_from_json(const nlohmann::json& document);
/// The same from text; fails also when it is longer than 64 KiB or not JSON.
Expected<ServiceModel> parse_service_model(std::string_view text);

/// One entry of a model's `examples`: an event, a command, or a command that is refused. The tests check
/// each.
struct ModelExample {
    std::string wire;      ///< "@D,e,2,{42,118}" or "D,A,100"; empty for an error example
    std::string json;      ///< compact
    std::string error;     ///< the expected reason
    std::string port_map;  ///< for events of shape kPorts: the body of the port map, "20,{4:1,...}"
    bool is_event() const { return !wire.empty() && wire.front() == '@'; }
};
std::vector<ModelExample> examples(const ServiceModel& model);

/// The units of all fields of its events and of all arguments of its commands, each once, in no special
/// order.
std::vector<std::string> units_of(const ServiceModel& model);

}  // namespace asip::model
