// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/change_event.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "asip/bus/registry/members.hpp"
#include "asip/model/json.hpp"

namespace asip::bus {
namespace {

using namespace members;
using nlohmann::json;

constexpr std::array<std::string_view, 7> kEventWords{"added",    "state",     "description", "conflict",
                                                      "resolved", "forgotten", "reset"};

}  // namespace

std::string_view to_string(ChangeEvent::Kind kind) {
    return kEventWords[static_cast<std::size_t>(kind)];
}

std::string encode(const ChangeEvent& event) {
    json object{{"event", to_string(event.kind)}, {"seq", event.seq}};
    put(object, "registry", event.registry);
    put(object, "epoch", event.epoch);
    put(object, "at", event.at);
    put(object, "was", event.was);
    put(object, "reason", event.reason);
    if (event.kind == ChangeEvent::Kind::kForgotten) {
        object["board"] = {{"board", event.board.board}};
    } else if (event.kind != ChangeEvent::Kind::kReset) {
        object["board"] = to_json(event.board);
    }
    return model::dump_json(object);
}

Expected<ChangeEvent> parse_change_event(std::string_view payload) {
    const auto document = object_from(payload);
    if (!document) return Unexpected<std::string>(document.error());
    const json& object = *document;
    ChangeEvent event;
    const std::string name = text_of(object, "event");
    std::size_t kind = 0;
    while (kind < kEventWords.size() && kEventWords[kind] != name)
        ++kind;
    if (kind == kEventWords.size()) return fail("event: \"" + name + "\" is not known");
    event.kind = static_cast<ChangeEvent::Kind>(kind);
    event.seq = number_of(object, "seq");
    event.registry = text_of(object, "registry");
    event.epoch = text_of(object, "epoch");
    event.at = time_of(object, "at");
    event.was = text_of(object, "was");
    event.reason = text_of(object, "reason");
    const auto board = object.find("board");
    if (board != object.end() && board->is_object()) event.board = read_board_item(*board);
    if (event.kind != ChangeEvent::Kind::kReset && event.board.board.empty()) return fail("board: missing");
    return event;
}

}  // namespace asip::bus
