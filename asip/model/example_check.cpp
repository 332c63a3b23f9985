// SPDX-License-Identifier: Apache-2.0
#include "asip/model/example_check.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <variant>

#include "asip/model/command_encoder.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"
#include "asip/protocol/message.hpp"

namespace asip::model {
namespace {

Expected<void> check_event(const ServiceModel& model, const ModelExample& example) {
    const auto message = protocol::parse_line(example.wire);
    const auto* event = std::get_if<protocol::Event>(&message);
    if (event == nullptr || event->service != model.id)
        return fail(example.wire + " is no event of service " + model.id);
    protocol::PortMap ports;
    if (!example.port_map.empty()) {
        auto map = protocol::PortMap::parse(example.port_map);
        if (!map) return fail("ports: " + map.error());
        ports = std::move(*map);
    }
    const auto decoded = decode_event(model, *event, {&ports, {}});
    if (!decoded) return fail(example.wire + ": " + decoded.error());
    if (dump_json(*decoded) != example.json)
        return fail(example.wire + " is " + dump_json(*decoded) + ", not " + example.json);
    return {};
}

Expected<void> check_refusal(const Expected<EncodedCommand>& encoded, const ModelExample& example) {
    if (encoded) return fail(example.json + " is not refused: it is " + encoded->line);
    if (encoded.error() == example.error) return {};
    return fail(example.json + " is refused with \"" + encoded.error() + "\", not \"" + example.error + "\"");
}

Expected<void> check_command(const ServiceModel& model, const Expected<EncodedCommand>& encoded,
                             const ModelExample& example) {
    if (!encoded) return fail(example.json + ": " + encoded.error());
    if (encoded->line != example.wire)
        return fail(example.json + " is " + encoded->line + ", not " + example.wire);
    const auto again = encode_text_command(model, std::string_view(example.wire).substr(2));
    if (!again) return fail(example.wire + ": " + again.error());
    if (again->line != example.wire) return fail(example.wire + " is understood as " + again->line);
    return {};
}

}  // namespace

Expected<void> check_example(const ServiceModel& model, const ModelExample& example) {
    if (example.is_event()) return check_event(model, example);
    const auto document = parse_json(example.json);
    if (!document) return fail(example.json + ": " + document.error());
    const auto encoded = encode_json_command(model, *document);
    if (!example.error.empty()) return check_refusal(encoded, example);
    if (example.wire.empty()) return fail(example.json + " has neither \"wire\" nor \"error\"");
    return check_command(model, encoded, example);
}

std::vector<std::string> missing_examples(const ServiceModel& model) {
    const auto all = examples(model);
    const auto shown = [&all](const std::string& beginning) {
        return std::any_of(all.begin(), all.end(),
                           [&](const ModelExample& example) { return example.wire.starts_with(beginning); });
    };
    std::vector<std::string> missing;
    for (const auto& event : model.events)
        if (!shown({'@', model.id, ',', event.tag}))
            missing.push_back("no example shows the event \"" + event.name + "\"");
    for (const auto& command : model.commands)
        if (!shown({model.id, ',', command.tag}))
            missing.push_back("no example shows the command \"" + command.name + "\"");
    if (!model.commands.empty() && std::none_of(all.begin(), all.end(), [](const ModelExample& example) {
            return !example.error.empty();
        }))
        missing.push_back("no example shows a command that is refused");
    return missing;
}

}  // namespace asip::model
