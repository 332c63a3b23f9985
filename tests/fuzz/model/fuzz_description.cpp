// SPDX-License-Identifier: Apache-2.0
// What anyone may publish as a board's description.
#include <cstdint>
#include <nlohmann/json.hpp>

#include "asip/model/board_state.hpp"
#include "asip/model/description.hpp"
#include "asip/model/names.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace asip::model;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    REQUIRE(valid_board_name(suggest_name(text)));
    REQUIRE(valid_board_name(text) == explain_board_name(text).empty());
    (void)board_state_from_text(text);
    const auto description = parse_description(text);
    if (!description) {
        REQUIRE(!description.error().empty());
        return 0;
    }
    REQUIRE(valid_board_name(description->board));
    REQUIRE(description->services.size() <= kMaxDescriptionServices);
    for (const auto& service : description->services)
        REQUIRE(valid_name(service.name));
    const auto again = parse_description(to_text(*description));
    REQUIRE(again.has_value() && *again == *description);
    return 0;
}
