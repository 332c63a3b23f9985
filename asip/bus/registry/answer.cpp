// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/answer.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/registry/members.hpp"
#include "asip/model/json.hpp"

namespace asip::bus {

namespace {

using namespace members;
using nlohmann::json;

// The rows of a large catalogue are written and read straight from and into text; a JSON tree costs ten times
// as much.
std::string encode_brief(json& envelope, const BriefRows& boards) {
    envelope["brief"] = true;
    std::string text = model::dump_json(envelope);
    text.pop_back();
    text += ",\"items\":";
    append_brief_rows(text, boards);
    text += '}';
    return text;
}

void append_json(std::string& text, const std::string& model) {
    text += model;
}

template <class Item>
std::string encode_items(const json& envelope, const std::vector<Item>& items) {
    std::string text = model::dump_json(envelope);
    text.pop_back();
    text += ",\"items\":[";
    for (const Item& item : items) {
        if (&item != &items.front()) text += ',';
        append_json(text, item);
    }
    text += "]}";
    return text;
}

constexpr std::array<std::string_view, 7> kEventWords{"added",    "state",     "description", "conflict",
                                                      "resolved", "forgotten", "reset"};

}  // namespace

std::string encode(const Answer& answer) {
    json object;
    put(object, "id", answer.id);
    put(object, "registry", answer.registry);
    if (!answer.refused.empty()) {
        object["refused"] = answer.refused;
        put(object, "error", answer.error);
        return model::dump_json(object);
    }
    put(object, "epoch", answer.epoch);
    object["seq"] = answer.seq;
    if (answer.settling) object["settling"] = true;
    if (answer.total) object["total"] = *answer.total;
    if (!answer.forgotten.empty()) object["forgotten"] = answer.forgotten;
    object["find"] = to_string(answer.find);
    put(object, "cursor", answer.cursor);
    put(object, "level", answer.level);
    if (answer.brief) return encode_brief(object, *answer.brief);
    if (!answer.services.empty()) return encode_items(object, answer.services);
    if (!answer.history.empty()) return encode_items(object, answer.history);
    if (!answer.values.empty()) return encode_items(object, answer.values);
    if (!answer.kept.empty()) return encode_items(object, answer.kept);
    if (!answer.models.empty()) return encode_items(object, answer.models);
    return encode_items(object, answer.boards);
}

Expected<Answer> parse_answer(std::string_view payload) {
    auto split = split_brief(payload);
    const auto document = object_from(split ? split->envelope : payload);
    if (!document) return Unexpected<std::string>(document.error());
    const json& object = *document;
    Answer answer;
    answer.id = text_of(object, "id");
    answer.registry = text_of(object, "registry");
    answer.epoch = text_of(object, "epoch");
    answer.seq = number_of(object, "seq");
    answer.settling = flag_of(object, "settling");
    answer.cursor = text_of(object, "cursor");
    answer.level = text_of(object, "level");
    answer.refused = text_of(object, "refused");
    answer.error = text_of(object, "error");
    const std::string find = text_of(object, "find");
    for (const Find each : {Find::kServices, Find::kHistory, Find::kModels, Find::kValues})
        if (find == to_string(each)) answer.find = each;
    if (object.contains("total")) answer.total = number_of(object, "total");
    if (const auto found = object.find("forgotten"); found != object.end() && found->is_array()) {
        for (const json& name : *found)
            if (name.is_string()) answer.forgotten.push_back(name.get<std::string>());
    }
    if (split) {
        if (!split->rows) return Unexpected<std::string>(split->rows.error());
        answer.brief = std::move(*split->rows);
        return answer;
    }
    const auto items = object.find("items");
    if (items == object.end() || !items->is_array()) {
        if (answer.refused.empty()) return fail("neither items nor a refusal");
        return answer;
    }
    for (const json& item : *items) {
        if (answer.find == Find::kValues && item.is_array()) {
            const auto point = read_value_point(item);
            if (!point) return fail("items: hold what is no [TIME,MEAN,MIN,MAX]");
            answer.values.push_back(*point);
            continue;
        }
        if (!item.is_object()) return fail("items: must be objects");
        if (answer.find == Find::kServices)
            answer.services.push_back(read_service_item(item));
        else if (answer.find == Find::kHistory)
            answer.history.push_back(read_history_item(item));
        else if (answer.find == Find::kValues)
            answer.kept.push_back(read_kept_property(item));
        else if (answer.find == Find::kModels)
            answer.models.push_back(model::dump_json(item));
        else
            answer.boards.push_back(read_board_item(item));
    }
    return answer;
}

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
    if (event.kind == ChangeEvent::Kind::kForgotten)
        object["board"] = {{"board", event.board.board}};
    else if (event.kind != ChangeEvent::Kind::kReset)
        object["board"] = to_json(event.board);
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
