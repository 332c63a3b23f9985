// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/oled.hpp"

namespace asip::sim {

const PartKind& sh1106_part();

namespace sh1106 {

// From its data sheet: 132 columns of memory, of which the usual glass shows 128, and no page but the one it
// was told.
constexpr OledController kController{132, 2, false};

PartPlan read_sh1106(PartReader& reader) {
    return Oled::read_plan(reader, [](std::string name, PartContext& context) -> std::unique_ptr<Part> {
        return std::make_unique<Oled>(std::move(name), sh1106_part(), kController, context);
    });
}

}  // namespace sh1106

const PartKind& sh1106_part() {
    static constexpr PartKind kind{"sh1106", Oled::kVerbs, sh1106::read_sh1106};
    return kind;
}

}  // namespace asip::sim
