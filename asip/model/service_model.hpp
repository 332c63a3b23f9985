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

/// What a value is, in JSON and on the wire.
enum class ValueType {
    kInteger,
    kNumber,  ///< a decimal fraction is allowed
    kText,    ///< printable ASCII
    kColor,   ///< an integer r<<16|g<<8|b; commands also take "#rrggbb"
    /// Argument: the number of items of the list Field::of; computed.
    kCount,
    /// Argument: one or more items, each with the fields Field::items.
    kList,
};
/// The word in a file: "integer", "number", "text", "color", "count", "list".
std::string_view to_text(ValueType type);

/// A field of an event, or an argument.
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

/// The layout of an event's body, and the JSON that it becomes.
enum class EventShape {
    kPerElement,  ///< COUNT,{...}: one item for each element -> array
    kOnce,        ///< COUNT,{...}: item i is field i -> object
    kPlain,       ///< a,b: no count and no braces -> object, or the value where there is one field
    kPorts,       ///< PORT,HEXMASK or COUNT,{PORT:HEXMASK,...} -> {"PIN":0|1}, through the port map
    kPortMap,     ///< COUNT,{PORT:HEXMASK} -> [{"port":,"mask":}]
    kMap,         ///< COUNT,{KEY:VALUE} -> {"KEY":VALUE}; without keys, the position is the key
};

struct EventModel {
    char tag = 0;
    std::string name;   ///< the member that carries it in JSON
    std::string title;  ///< for a person
    EventShape shape = EventShape::kPerElement;
    std::vector<Field> fields;
};

/// The argument in this place, or a number.
struct SafeArgument {
    std::optional<std::size_t> given;  ///< place among the arguments that the caller gives
    double number = 0;
};

struct SafeForm {
    std::string command;  ///< name of the command that is sent instead; may be the same
    std::vector<SafeArgument> arguments;
};

struct CommandModel {
    char tag = 0;
    std::string name;
    std::string title;  ///< for a person
    std::vector<Field> args;
    char answer = 0;  ///< tag of the event that answers it; 0: none
    /// How long behind its execution that event may come; none: not said.
    std::optional<std::chrono::milliseconds> answer_time;
    std::optional<SafeForm> safe;  ///< none: nothing undoes it
};

/// All but the counts, in order. Valid as long as `command`.
std::vector<const Field*> given_arguments(const CommandModel& command);

class ModelHints;

/// The contents of one file of services/. Unchanged once loaded, so pointers into it stay valid.
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

    std::string ref() const;

    // Each returns null where there is none. Of several commands with one tag, the first.
    const EventModel* event(char tag) const;
    const EventModel* event_named(std::string_view event_name) const;
    const CommandModel* command(std::string_view command_name) const;
    const CommandModel* command_with_tag(char tag) const;

    /// The letter and, where the board gave one, the friendly name are of this model. Only letters and digits
    /// count, without case; a name matches when it contains a word of `match`.
    bool matches(char letter, std::string_view friendly_name) const;
};

/// From JSON of anyone. Fails with the first fault and its place, "/commands/report/args/0/type: ...": it
/// breaks services/schema.json, has control characters outside its examples, or contradicts itself (two
/// events may not share tag or name).
Expected<ServiceModel> service_model_from_json(const nlohmann::json& document);
/// From text of at most 64 KiB.
Expected<ServiceModel> parse_service_model(std::string_view text);

/// One of a model's `examples`: an event, a command, or a refused command. The tests check each.
struct ModelExample {
    std::string wire;      ///< "@D,e,2,{42,118}" or "D,A,100"; empty for an error example
    std::string json;      ///< compact
    std::string error;     ///< the expected reason
    std::string port_map;  ///< for events of shape kPorts: the body of the port map, "20,{4:1,...}"
    bool is_event() const { return !wire.empty() && wire.front() == '@'; }
};
std::vector<ModelExample> examples(const ServiceModel& model);

/// The units of all fields and arguments, each once, unordered.
std::vector<std::string> units_of(const ServiceModel& model);

}  // namespace asip::model
