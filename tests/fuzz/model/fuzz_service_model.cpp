// SPDX-License-Identifier: Apache-2.0
// What a stranger may carry as a service model, and commands encoded and events decoded by it.
#include <cstdint>
#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace asip;
    const auto model = model::parse_service_model({reinterpret_cast<const char*>(data), size});
    if (!model) {
        REQUIRE(!model.error().empty());
        return 0;
    }
    const auto again = model::parse_service_model(model->source);
    REQUIRE(again.has_value() && again->source == model->source);
    for (const auto& example : model::examples(*model)) {
        const auto message = protocol::parse_line(example.wire);
        if (const auto* event = std::get_if<protocol::Event>(&message))
            (void)model::decode_event(*model, *event);
        if (const auto command = model::parse_json(example.json))
            (void)model::encode_json_command(*model, *command);
        if (example.wire.size() > 2)
            (void)model::encode_text_command(*model, std::string_view(example.wire).substr(2));
    }
    for (const auto& command : model->commands)
        (void)model::usage(command);
    return 0;
}
