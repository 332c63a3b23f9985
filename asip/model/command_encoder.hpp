// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::model {

/// A checked command, ready to be sent, and what is to be expected of it.
struct EncodedCommand {
    std::string line;     ///< "S,W,0,90", without newline, at most protocol::kMaxRequestBytes bytes
    std::string command;  ///< its name in the model; empty for a service without a model
    char service = 0;
    char tag = 0;
    char answer = 0;  ///< tag of the event that answers it; 0: none
    /// How long after its execution that event may come; none: the model does not say.
    std::optional<std::chrono::milliseconds> answer_time;
    std::string safe;  ///< the request line that undoes it, "M,s,0"; empty: nothing does
};

// Each checks the command's name and the number, types and ranges of its arguments, and fails with a reason
// for a person: "period: 70000 is above 65535", "no command 'wirte'; did you mean 'write'?". What succeeds
// fits a request line and is what the board's firmware accepts, as far as its model goes.

/// {"write":[0,90]}, {"write":{"servo":0,"angle":90}}, {"measure":null} (also [] , {} , true), {"report":100}
/// for one argument. The object has one member, the command; members "id" and "reply_to" are passed over.
/// Numbers must be JSON numbers.
Expected<EncodedCommand> encode_json_command(const ServiceModel& model, const nlohmann::json& command);

/// ASIP text without its service: "W,0,90". Checked against the model's commands with that tag; a tag that
/// the model does not have is refused.
Expected<EncodedCommand> encode_text_command(const ServiceModel& model, std::string_view text);

/// Words as a person typed them: {"write","0","90"}. The first is the name of a command, or its tag; an item
/// of a list with several fields is one word: "0:255". Arguments by name, in any order: {"write","angle=90",
/// "servo=0"}.
Expected<EncodedCommand> encode_word_command(const ServiceModel& model, std::span<const std::string> words);

/// What stands behind the name of a command in JSON, [0,90], {"servo":0,"angle":90} or 90, as an array with
/// the value of each of given_arguments(), in order. Fails when an argument is unknown or, in the form with
/// names, missing; the number of values and what they are is not checked.
Expected<nlohmann::json> argument_values(const CommandModel& command, const nlohmann::json& given);

/// A command for the service `letter` as its control topic carries it: ASIP text without the service
/// ("W,0,90", a line end is allowed), or an object as for encode_json_command() or {"raw":"W,0,90"}. `model`
/// may be null: then only ASIP text and {"raw":...} are taken, and only the form of the line is checked.
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

/// A request as its model reads it.
struct RequestValues {
    const CommandModel* command = nullptr;  ///< of the model
    /// The value of each of given_arguments(), in order: numbers (a color is one, too), texts, and for a list
    /// an array of its items. An item with several fields is an array.
    nlohmann::json values;
};

/// ASIP text without its service, "W,0,90". Fails where encode_text_command() does.
Expected<RequestValues> request_values(const ServiceModel& model, std::string_view text);

}  // namespace asip::model
