// SPDX-License-Identifier: Apache-2.0
// A line of a board, decoded by each standard model of its letter.
#include <cstdint>
#include <nlohmann/json.hpp>

#include "asip/model/event_decoder.hpp"
#include "asip/model/json.hpp"
#include "asip/model/model_set.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace asip;
    const std::string_view line(reinterpret_cast<const char*>(data), size);
    const auto message = protocol::parse_line(line);
    const auto* event = std::get_if<protocol::Event>(&message);
    if (event == nullptr) return 0;
    static const auto ports = protocol::PortMap::parse("4,{4:1,4:2,5:80,5:ff}").value();
    static const std::vector<protocol::PinMode> modes = {protocol::PinMode::kInput,
                                                         protocol::PinMode::kOutput};
    for (const auto& model : model::ModelSet::standard().all()) {
        if (model->id != event->service) continue;
        const auto decoded = model::decode_event(*model, *event, {&ports, modes});
        if (!decoded) continue;
        REQUIRE(decoded->is_object() && decoded->size() == 1);
        REQUIRE(decoded->contains(model->event(event->tag)->name));
        REQUIRE(model::parse_json(model::dump_json(*decoded)).has_value());
    }
    return 0;
}
