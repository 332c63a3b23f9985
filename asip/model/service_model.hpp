#pragma once
#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/expected.hpp"

namespace asip::model {

/// What one value is.
enum class ValueType {
    Integer,
    Number,  // decimal fraction allowed
    Text,
    Color,  // an integer r<<16|g<<8|b; commands also take "#rrggbb"
    Count,  // arguments only: number of items of the list named by `of`; computed, never given by the caller
    List,   // arguments only: one or more items, each with the fields in `items`
};
std::string_view to_text(ValueType type);

/// A field of an event or an argument of a command.
struct Field {
    std::string name;
    ValueType type = ValueType::Integer;
    std::string title;
    std::string unit;
    std::optional<double> min;  // of the number
    std::optional<double> max;
    std::optional<std::size_t> max_length;            // of text, in bytes; of a list, in items
    std::vector<std::pair<std::string, long>> names;  // numbers that have a name: {"input", 1}
    std::string of;                                   // Count: the list's name
    std::vector<Field> items;                         // List: fields of one item, joined by ':' on the wire
    bool braces = false;                              // List: `{a,b}` instead of `a,b`
};

/// How the body of an event is laid out.
enum class EventShape {
    PerElement,  // COUNT,{...}: one item an element -> array
    Once,        // COUNT,{...}: item i is field i -> object
    Plain,       // a,b: no count and no braces -> object, or the value where there is one field
    Ports,       // PORT,HEXMASK -> {"PIN":0|1}, through the port map
    PortMap,     // COUNT,{PORT:HEXMASK} -> [{"port":,"mask":}]
    Map,         // COUNT,{KEY:VALUE} -> {"KEY":VALUE}; without keys, the position is the key
};

struct EventModel {
    char tag = 0;
    std::string name;  // the member that carries it in JSON
    std::string title;
    EventShape shape = EventShape::PerElement;
    std::vector<Field> fields;
};

/// An argument of a safe form: the one that was given in this place, or a number.
struct SafeArgument {
    std::optional<std::size_t> given;  // place among the arguments that the caller gives
    double number = 0;
};

/// What undoes a command.
struct SafeForm {
    std::string command;  // name of the command that is sent instead; may be the same
    std::vector<SafeArgument> arguments;
};

struct CommandModel {
    char tag = 0;
    std::string name;
    std::string title;
    std::vector<Field> args;
    char answer = 0;                                       // tag of the event that answers it; 0: none
    std::optional<std::chrono::milliseconds> answer_time;  // within which that event comes, once executed
    std::optional<SafeForm> safe;                          // none: nothing undoes it
};

/// The arguments that a caller gives: all but the counts, in order.
std::vector<const Field*> given_arguments(const CommandModel& command);

/// One kind of service: the contents of one file of services/. Immutable once loaded.
struct ServiceModel {
    std::string name;
    int version = 1;
    char id = 0;
    std::vector<std::string> match;  // friendly names of 0.4 boards; see matches()
    std::string title;
    std::string element;  // what one element is called: "sensor"; may be empty
    std::vector<EventModel> events;
    std::vector<CommandModel> commands;
    std::vector<std::string> safe;  // request lines that bring the whole service into its safe state: "M,S"
    std::string source;             // its JSON text, compact, without examples
    std::string example_source;     // the array "examples", compact; empty where there is none

    std::string ref() const;  // "distance@1"
    const EventModel* event(char tag) const;
    const EventModel* event_named(std::string_view event_name) const;
    const CommandModel* command(std::string_view command_name) const;
    const CommandModel* command_with_tag(char tag) const;

    /// By letter, and by friendly name where the board gave one: case and everything but letters and digits
    /// ignored, a name matches when it contains a word of `match` ("ASIP Distance" and "Distance" both match
    /// "Distance").
    bool matches(char letter, std::string_view friendly_name) const;
};

/// From a model's JSON; fails with "/commands/report/args/0/type: ..." when it breaks services/schema.json or
/// names contradict each other (two commands with one tag are allowed, two events with one tag or name are
/// not).
Expected<ServiceModel> service_model_from_json(const nlohmann::json& document);
/// The same from text that anyone may have written.
Expected<ServiceModel> parse_service_model(std::string_view text);

/// One vector of a model's `examples`: an event, a command, or a command that is refused.
struct ModelExample {
    std::string wire;   // "@D,e,2,{42,118}" or "D,A,100"; empty for an error example
    std::string json;   // compact
    std::string error;  // the expected reason
    bool is_event() const { return !wire.empty() && wire.front() == '@'; }
    /// For events of shape Ports: the port map's body, "20,{4:1,...}".
    std::string port_map;
};
std::vector<ModelExample> examples(const ServiceModel& model);

/// The units of all fields of its events and of all arguments of its commands, each once.
std::vector<std::string> units_of(const ServiceModel& model);

}  // namespace asip::model
