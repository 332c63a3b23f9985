// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/protocol/request.hpp"

namespace asip::model {

Expected<EncodedCommand> encode_control_text(const ServiceModel* model, char letter, std::string_view text) {
    text = protocol::significant(text);
    if (model != nullptr) return encode_text_command(*model, text);
    const auto line = std::string{letter, ','} + std::string(text.substr(0, protocol::kMaxPayloadBytes));
    const auto request = protocol::parse_request(line);
    if (!request) return fail(request.error());
    return EncodedCommand{line, {}, letter, request->tag, 0, std::nullopt, {}};
}

Expected<EncodedCommand> encode_control_json(const ServiceModel* model, char letter,
                                             const nlohmann::json& object) {
    if (!object.is_object()) return fail("a command is an object such as {\"NAME\":[ARGUMENTS]}");
    const auto raw = object.find("raw");
    if (raw != object.end() && (model == nullptr || model->command("raw") == nullptr)) {
        if (!raw->is_string()) return fail("raw: is not a string");
        return encode_control_text(model, letter, raw->get_ref<const std::string&>());
    }
    if (model != nullptr) return encode_json_command(*model, object);
    return fail("no model describes service " + std::string(1, letter) +
                ": send ASIP text, or {\"raw\":\"TAG,...\"}");
}

}  // namespace asip::model
