#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/protocol/request.hpp"

namespace asip::model {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxIdBytes = 64;
constexpr std::size_t kMaxTopicBytes = 256;
constexpr JsonLimits kControlLimits = {8192, 8};

bool looks_like_json(std::string_view payload) {
    const auto first = payload.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && (payload[first] == '{' || payload[first] == '[');
}

/// A member that is text (an id may be a number), if it is not too long and clean enough to be said back.
std::string bounded_text(const json& object, const char* key, std::size_t max_bytes) {
    const auto found = object.find(key);
    if (found == object.end()) return {};
    const auto text = found->is_string()           ? found->get<std::string>()
                      : found->is_number_integer() ? dump_json(*found)
                                                   : "";
    const bool clean = std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20; });
    return clean && text.size() <= max_bytes ? text : std::string{};
}

/// Where the answer is published; a wildcard or `$` topic is nobody's mailbox.
std::string reply_topic(const json& object) {
    auto topic = bounded_text(object, "reply_to", kMaxTopicBytes);
    return topic.find_first_of("+#") == std::string::npos && !topic.starts_with('$') ? topic : std::string{};
}

std::string_view without_line_end(std::string_view text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r'))
        text.remove_suffix(1);
    return text;
}

Expected<EncodedCommand> encode_text(const ServiceModel* model, char letter, std::string_view text) {
    text = without_line_end(text);
    if (model != nullptr) return encode_text_command(*model, text);
    const auto line = std::string{letter, ','} + std::string(text.substr(0, protocol::kMaxPayloadBytes));
    const auto request = protocol::parse_request(line);
    if (!request) return fail(request.error());
    return EncodedCommand{line, {}, letter, request->tag, 0};
}

Expected<EncodedCommand> encode_object(const ServiceModel* model, char letter, const json& object) {
    const auto raw = object.find("raw");
    if (raw != object.end() && (model == nullptr || model->command("raw") == nullptr)) {
        if (!raw->is_string()) return fail("raw: is no text");
        return encode_text(model, letter, raw->get_ref<const std::string&>());
    }
    if (model != nullptr) return encode_json_command(*model, object);
    return fail("no model describes service " + std::string(1, letter) +
                ": send ASIP text, or {\"raw\":\"TAG,...\"}");
}

Expected<std::vector<std::string>> owned_lines(std::string_view payload) {
    const auto lines = protocol::split_requests(payload);
    if (!lines) return fail(lines.error());
    return std::vector<std::string>(lines->begin(), lines->end());
}

Expected<std::vector<std::string>> raw_lines(const json& object) {
    const auto raw = object.find("raw");
    if (raw == object.end())
        return fail("there is no \"raw\" in it; a command by name goes to BOARD/SERVICE/in");
    if (raw->is_string()) return owned_lines(raw->get_ref<const std::string&>());
    if (!raw->is_array()) return fail("raw: is neither text nor an array of lines");
    std::string text;
    for (const auto& line : *raw) {
        if (!line.is_string()) return fail("raw: holds something that is no text");
        text += line.get_ref<const std::string&>() + "\n";
    }
    return owned_lines(text);
}

}  // namespace

ControlRequest read_control(const ServiceModel* model, char letter, std::string_view payload) {
    if (!looks_like_json(payload)) return {{}, {}, encode_text(model, letter, payload)};
    const auto object = parse_json(payload, kControlLimits);
    if (!object) return {{}, {}, fail(object.error())};
    if (!object->is_object()) return {{}, {}, fail("a command is an object such as {\"NAME\":[ARGUMENTS]}")};
    return {bounded_text(*object, "id", kMaxIdBytes), reply_topic(*object),
            encode_object(model, letter, *object)};
}

RawControl read_raw_control(std::string_view payload) {
    if (!looks_like_json(payload)) return {{}, {}, owned_lines(payload)};
    const auto object = parse_json(payload, kControlLimits);
    if (!object) return {{}, {}, fail(object.error())};
    if (!object->is_object()) return {{}, {}, fail("a raw command is an object such as {\"raw\":\"#,?\"}")};
    return {bounded_text(*object, "id", kMaxIdBytes), reply_topic(*object), raw_lines(*object)};
}

}  // namespace asip::model
