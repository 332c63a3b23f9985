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

/// A checked command, ready to be sent.
struct EncodedCommand {
    std::string line;     ///< "S,W,0,90", without newline, at most protocol::kMaxRequestBytes bytes
    std::string command;  ///< its name in the model; empty for a service without a model
    char service = 0;
    char tag = 0;
    char answer = 0;  ///< tag of the event that answers it; 0: none
    /// How long behind its execution that event may come; none: the model does not say.
    std::optional<std::chrono::milliseconds> answer_time;
    std::string safe;  ///< the request line that undoes it, "M,s,0"; empty: nothing does
};

// Each checks the command's name and the number, types and ranges of its arguments, and fails with a reason
// for a person: "period: 70000 is above 65535", "no command 'wirte'; did you mean 'write'?". What succeeds
// fits a request line and is what the board's firmware accepts, as far as its model goes.

/// {"write":[0,90]}, {"write":{"servo":0,"angle":90}}, {"measure":null} (also [] , {} , true), {"report":100}
/// for one argument. One member, the command, beside "id" and "reply_to", which are passed over. Numbers must
/// be JSON numbers.
Expected<EncodedCommand> encode_json_command(const ServiceModel& model, const nlohmann::json& command);

/// ASIP text without its service: "W,0,90". A tag that the model lacks is refused.
Expected<EncodedCommand> encode_text_command(const ServiceModel& model, std::string_view text);

/// Typed words: {"write","0","90"}. First the name of a command, or its tag; an item with several fields is
/// one word: "0:255". By name, in any order: {"write","angle=90","servo=0"}.
Expected<EncodedCommand> encode_word_command(const ServiceModel& model, std::span<const std::string> words);

/// From JSON behind a command's name, [0,90], {"servo":0,"angle":90} or 90, an array with the value of each
/// of given_arguments(). Fails on an unknown argument or, by name, a missing one; number and contents are not
/// checked.
Expected<nlohmann::json> argument_values(const CommandModel& command, const nlohmann::json& given);

/// As control topics carry it: ASIP text without the service ("W,0,90", a line end is allowed), or an object
/// as for encode_json_command(), or {"raw":"W,0,90"}. With a null `model` only ASIP text and {"raw":...} are
/// taken, and only the line's form is checked.
Expected<EncodedCommand> encode_control_text(const ServiceModel* model, char letter, std::string_view text);
Expected<EncodedCommand> encode_control_json(const ServiceModel* model, char letter,
                                             const nlohmann::json& object);

/// With type, range and unit: "angle 0..180 degrees".
std::string describe(const Field& field);
/// All arguments: "servo 0..255, angle 0..180 degrees"; may be empty.
std::string usage(const CommandModel& command);
/// What undoes a command, with the arguments' names: "M,s,motor"; empty: nothing does.
std::string safe_usage(const ServiceModel& model, const CommandModel& command);

struct RequestValues {
    const CommandModel* command = nullptr;  ///< of the model
    /// For each of given_arguments(), in order: numbers (a color is one), texts, and arrays for lists and for
    /// items with several fields.
    nlohmann::json values;
};

/// From ASIP text without its service, "W,0,90". Fails where encode_text_command() does.
Expected<RequestValues> request_values(const ServiceModel& model, std::string_view text);

}  // namespace asip::model
