// SPDX-License-Identifier: Apache-2.0
// Bytes of a Sparkplug host: what is read of them is what the judge of tests/readers says, is written, and
// read as the same; whatever its metrics want of a property is a command for it, or refused in words.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "gateway/export/sparkplug.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/readers/sparkplug_judge.hpp"

namespace {

using namespace asip::gateway::exports;

std::vector<Property> properties() {
    Property servo;
    servo.id = "servo";
    servo.kind = Kind::kNumber;
    servo.whole = true;
    servo.max = 180;
    servo.write = asip::property::Call{"servo", "write", {0, std::nullopt}};
    Property light;
    light.id = "light";
    light.kind = Kind::kLight;
    light.write = asip::property::Call{"pixels", "brightness", {std::nullopt}};
    light.color = asip::property::Call{"pixels", "fill", {std::nullopt}};
    Property text;
    text.id = "text";
    text.kind = Kind::kText;
    text.max_length = 20;
    text.write = asip::property::Call{"display", "line", {std::nullopt}};
    Property power;
    power.id = "power";
    power.kind = Kind::kSwitch;
    power.choices = {{"off", 0}, {"on", 1}};
    power.write = asip::property::Call{"io", "write", {13, std::nullopt}};
    return {servo, light, text, power};
}

void command(const Sparkplug& dialect, const sparkplug::Payload& payload) {
    static const auto all = properties();
    for (const auto& property : all) {
        for (const auto& slot : Sparkplug::slots(property)) {
            std::vector<Sparkplug::Wanted> wanted;
            for (const auto& metric : payload.metrics)
                wanted.push_back({slot.part, metric.value});
            const auto value =
                dialect.value_of(property, wanted, nlohmann::json{{"on", true}, {"brightness", 9}});
            if (value)
                REQUIRE(!requests_for(property, *value).empty());
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
    const auto read = payload ? std::optional(*payload) : std::nullopt;
    REQUIRE(readers::judge_sparkplug(bytes, read) == nullptr);
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
