// SPDX-License-Identifier: Apache-2.0
// Bytes as a board might send them: first byte says how they are cut into reads.
#include <cstdint>

#include "asip/protocol/board_info.hpp"
#include "asip/protocol/body.hpp"
#include "asip/protocol/checksum.hpp"
#include "asip/protocol/extensions.hpp"
#include "asip/protocol/line_reader.hpp"
#include "asip/protocol/message.hpp"
#include "asip/protocol/port_map.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace asip::protocol;

void read_bodies(std::string_view body) {
    if (const auto parsed = parse_body(body)) {
        REQUIRE(parsed->items.size() <= kMaxBodyItems);
        for (const auto item : parsed->items)
            REQUIRE(!split_fields(item).empty());
    }
    if (const auto map = PortMap::parse(body))
        for (const std::uint32_t levels : {0u, 0xffffffffu})
            REQUIRE(map->levels({4, levels}).size() <= map->positions().size());
    (void)parse_port_state(body);
    (void)parse_board_info(body);
    (void)parse_service_names(body);
    (void)parse_pin_owners(body);
    (void)parse_pin_modes(body);
    (void)parse_pin_capabilities(body);
    (void)parse_analog_map(body);
    (void)parse_extensions(body);
}

void read_line(std::string_view line) {
    REQUIRE(!line.empty() && line.size() <= 200 && line.find('\n') == std::string_view::npos);
    const auto message = parse_line(line);
    if (const auto* event = std::get_if<Event>(&message)) read_bodies(event->body);
    if (const auto* error = std::get_if<ErrorReply>(&message)) REQUIRE(!error_name(error->code).empty());
    if (const auto* info = std::get_if<Info>(&message)) (void)parse_banner(info->text);
    if (const auto plain = verify_checksum(line)) REQUIRE(plain->size() + 3 == line.size());
    REQUIRE(verify_checksum(append_checksum(line)).value() == line);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::size_t piece = data[0] + 1u;
    std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    LineReader reader(200);
    std::size_t lines = 0;
    while (!bytes.empty()) {
        reader.push(bytes.substr(0, piece), [&](std::string_view line) {
            read_line(line);
            ++lines;
        });
        REQUIRE(reader.partial_bytes() <= 201);
        bytes.remove_prefix(std::min(piece, bytes.size()));
    }
    // Whatever came before, the next good message works.
    bool understood = false;
    reader.push("\n@D,e,1,{7}\n", [&](std::string_view line) {
        const auto message = parse_line(line);
        const auto* event = std::get_if<Event>(&message);
        understood = event != nullptr && event->service == 'D' && event->body == "1,{7}";
    });
    REQUIRE(understood);
    return 0;
}
