// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/answer.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/registry/members.hpp"
#include "asip/model/json.hpp"

namespace asip::bus {
namespace {

using namespace members;
using nlohmann::json;

struct LinesSplit {
    std::string envelope;
    std::string lines;
};

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

std::string encode_models(const json& envelope, const std::vector<std::string>& models) {
    std::string text = model::dump_json(envelope);
    text.pop_back();
    text += ",\"items\":[";
    for (const std::string& each : models) {
        if (&each != &models.front()) text += ',';
        text += each;
    }
    text += "]}";
    return text;
}

/// One line, whatever program wrote it.
bool append_line(std::string_view object, std::string& lines) {
    if (object.front() != '{') return false;
    const bool one_line = object.find('\n') == object.npos && object.find('\r') == object.npos;
    if (one_line) {
        lines += object;
    } else {
        lines += model::dump_json(json::parse(object, nullptr, false));
    }
    lines += '\n';
    return true;
}

/// An answer whose items are taken out as lines; nothing where it has none that could be.
std::optional<LinesSplit> split_lines(std::string_view payload) {
    if (payload.size() > kMaxPayload) return std::nullopt;
    JsonScanner in(payload);
    if (!in.enter_object()) return std::nullopt;
    LinesSplit split;
    std::string_view key;
    std::string_view value;
    bool found = false;
    while (in.next_member(key)) {
        if (key != "items") {
            if (!in.value(value)) return std::nullopt;
            split.envelope.append(split.envelope.empty() ? "{\"" : ",\"")
                .append(in.raw_key())
                .append("\":")
                .append(value);
            continue;
        }
        if (std::exchange(found, true) || !in.enter_array()) return std::nullopt;
        split.lines.reserve(payload.size() + 1000);
        while (in.next_element()) {
            if (!in.value(value) || !append_line(value, split.lines)) return std::nullopt;
        }
        if (!in.left()) return std::nullopt;
    }
    if (!in.left() || !in.at_end() || !found) return std::nullopt;
    split.envelope += split.envelope.empty() ? "{\"items\":[]}" : ",\"items\":[]}";
    return split;
}

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
    if (answer.brief) return encode_brief(object, *answer.brief);
    if (!answer.services.empty()) return encode_items(object, answer.services);
    if (!answer.history.empty()) return encode_items(object, answer.history);
    if (!answer.models.empty()) return encode_models(object, answer.models);
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
    answer.refused = text_of(object, "refused");
    answer.error = text_of(object, "error");
    const std::string find = text_of(object, "find");
    for (const Find each : {Find::kServices, Find::kHistory, Find::kModels}) {
        if (find == to_string(each)) answer.find = each;
    }
    if (object.contains("total")) answer.total = number_of(object, "total");
    if (const auto found = object.find("forgotten"); found != object.end() && found->is_array()) {
        for (const json& name : *found) {
            if (name.is_string()) answer.forgotten.push_back(name.get<std::string>());
        }
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
        if (!item.is_object()) return fail("items: must be objects");
        if (answer.find == Find::kServices) {
            answer.services.push_back(read_service_item(item));
        } else if (answer.find == Find::kHistory) {
            answer.history.push_back(read_history_item(item));
        } else if (answer.find == Find::kModels) {
            answer.models.push_back(model::dump_json(item));
        } else {
            answer.boards.push_back(read_board_item(item));
        }
    }
    return answer;
}

Expected<AnswerLines> parse_answer_lines(std::string_view payload) {
    AnswerLines result;
    auto split = split_lines(payload);
    auto answer = parse_answer(split ? split->envelope : payload);
    if (!answer) return Unexpected<std::string>(answer.error());
    if (split) result.lines = std::move(split->lines);
    const auto append = [&result](const auto& items) {
        for (const auto& item : items) {
            append_json(result.lines, item);
            result.lines += '\n';
        }
    };
    // What only a parser of whole documents takes apart.
    append(std::exchange(answer->boards, {}));
    append(std::exchange(answer->services, {}));
    result.answer = std::move(*answer);
    return result;
}

}  // namespace asip::bus
