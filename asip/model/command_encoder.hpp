#pragma once
#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::model {

struct EncodedCommand {
    std::string line;     // "S,W,0,90", without newline, at most protocol::kMaxRequestBytes
    std::string command;  // its name in the model; empty for a service without a model
    char service = 0;
    char tag = 0;
    char answer = 0;                                       // tag of the event that answers it; 0: none
    std::optional<std::chrono::milliseconds> answer_time;  // after its execution; none: nothing is known
    std::string safe;  // the request line that undoes it, "M,s,0"; empty: nothing does
};

// Each checks name, count, types and ranges, and fails with a reason for a person: "period: 70000 is above
// 65535", "no command 'wirte'; did you mean 'write'?". Nothing is sent half-checked.

/// {"write":[0,90]}, {"write":{"servo":0,"angle":90}}, {"measure":null} (also [] , {} , true), {"report":100}
/// for one argument. Members "id" and "reply_to" are passed over.
Expected<EncodedCommand> encode_json_command(const ServiceModel& model, const nlohmann::json& command);

/// The request without its service: "W,0,90". Checked against the model's command with that tag; a tag the
/// model does not know is refused.
Expected<EncodedCommand> encode_text_command(const ServiceModel& model, std::string_view text);

/// As typed: {"write","0","90"}; items of a list may be "0:255". The first word is a command's name, or the
/// tag.
Expected<EncodedCommand> encode_word_command(const ServiceModel& model, std::span<const std::string> words);

/// A command for the service `letter` as its control topic carries it: ASIP text without the service
/// ("W,0,90", a line end is allowed), or an object as for encode_json_command() or {"raw":"W,0,90"}. `model`
/// may be null: then only ASIP text is taken, and only its form is checked.
Expected<EncodedCommand> encode_control_text(const ServiceModel* model, char letter, std::string_view text);
Expected<EncodedCommand> encode_control_json(const ServiceModel* model, char letter,
                                             const nlohmann::json& object);

/// A field or argument with its type, range and unit, for help texts: "angle 0..180 degrees".
std::string describe(const Field& field);
/// All arguments of a command: "servo 0..255, angle 0..180 degrees"; empty where there is none.
std::string usage(const CommandModel& command);
/// The request that undoes a command, with the names of the arguments it takes over: "M,s,motor"; empty where
/// nothing undoes it.
std::string safe_usage(const ServiceModel& model, const CommandModel& command);

}  // namespace asip::model
