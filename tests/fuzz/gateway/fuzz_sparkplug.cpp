// SPDX-License-Identifier: Apache-2.0
// Bytes of a Sparkplug host: what can be read is written, and read as the same; whatever its metrics want of
// an entity is a command for it, or refused in words.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "gateway/export/sparkplug.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace asip::gateway::exports;

std::vector<Entity> entities() {
    Entity servo;
    servo.id = "servo";
    servo.kind = EntityKind::kNumber;
    servo.whole = true;
    servo.max = 180;
    servo.write = Call{"servo", "write", {0, std::nullopt}, "angle", true};
    Entity light;
    light.id = "light";
    light.kind = EntityKind::kLight;
    light.write = Call{"pixels", "brightness", {std::nullopt}, "level"};
    light.color = Call{"pixels", "fill", {std::nullopt}, "color"};
    Entity text;
    text.id = "text";
    text.kind = EntityKind::kText;
    text.max_length = 20;
    text.write = Call{"display", "line", {std::nullopt}, "text"};
    Entity power;
    power.id = "power";
    power.kind = EntityKind::kSwitch;
    power.options = {{"off", 0}, {"on", 1}};
    power.write = Call{"io", "write", {13, std::nullopt}, "level", true};
    return {servo, light, text, power};
}

void command(const Sparkplug& dialect, const sparkplug::Payload& payload) {
    static const auto all = entities();
    for (const auto& entity : all) {
        for (const auto& slot : Sparkplug::slots(entity)) {
            std::vector<Sparkplug::Wanted> wanted;
            for (const auto& metric : payload.metrics)
                wanted.push_back({slot.part, metric.value});
            const auto value =
                dialect.value_of(entity, wanted, nlohmann::json{{"on", true}, {"brightness", 9}});
            if (value)
                REQUIRE(!requests_for(entity, *value).empty());
            else
                REQUIRE(!value.error().empty());
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    Sparkplug::host_state_from(bytes);
    const auto payload = sparkplug::read(bytes);
    if (!payload) {
        REQUIRE(!payload.error().empty());
        return 0;
    }
    REQUIRE(payload->metrics.size() <= sparkplug::kMaxMetrics);
    const auto written = sparkplug::write(*payload);
    if (written.size() <= sparkplug::kMaxPayloadBytes) {
        const auto again = sparkplug::read(written);
        REQUIRE(again);
        REQUIRE(again->metrics.size() == payload->metrics.size());
        // A number whose type says otherwise is another one after the first time, and then stays.
        REQUIRE(sparkplug::write(*sparkplug::read(sparkplug::write(*again))) == sparkplug::write(*again));
    }
    command(Sparkplug({}), *payload);
    return 0;
}
