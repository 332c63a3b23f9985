// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/oled.hpp"

namespace asip::sim {

const PartKind& ssd1306_part();

namespace ssd1306 {

// From its data sheet: 128 columns of memory, and steps from page to page.
constexpr OledController kController{128, 0, true};

PartPlan read_ssd1306(PartReader& reader) {
    return Oled::read_plan(reader, [](std::string name, PartContext& context) -> std::unique_ptr<Part> {
        return std::make_unique<Oled>(std::move(name), ssd1306_part(), kController, context);
    });
}

}  // namespace ssd1306

const PartKind& ssd1306_part() {
    static constexpr PartKind kind{"ssd1306", Oled::kVerbs, ssd1306::read_ssd1306};
    return kind;
}

}  // namespace asip::sim
