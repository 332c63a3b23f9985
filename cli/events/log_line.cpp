// SPDX-License-Identifier: Apache-2.0
#include "cli/events/log_line.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::cli {
namespace {

using nlohmann::json;

std::string text_of(const json& value) {
    return value.is_string() ? value.get<std::string>() : value.is_null() ? "" : model::dump_json(value);
}

std::string text_of(const json& object, const char* name) {
    return object.contains(name) ? text_of(object.at(name)) : std::string();
}

/// `{"request":"W","code":7,"error":"INVALID_DEVICE_NUMBER"}`
std::string error_text(const json& error) {
    auto text = text_of(error, "request") + ": ";
    if (error.contains("reason")) text += text_of(error, "reason") + ", ";
    text += text_of(error, "error");
    if (error.contains("code")) text += " (" + text_of(error, "code") + ")";
    return text;
}

/// `{"level":"warning","text":"board silent","why":"..."}`
std::string agent_text(const json& line) {
    auto text = text_of(line, "text");
    for (const auto& [name, value] : line.items())
        if (name != "text" && name != "level" && name != "time" && name != "board")
            text += "  " + name + "=" + text_of(value);
    return text;
}

}  // namespace

std::optional<LogLine> log_line(const bus::Topics& topics, const mqtt::Message& message) {
    const auto topic = topics.parse(message.topic);
    if (!topic || message.retain) return std::nullopt;
    LogLine line{std::string(topic->board), "board", "info", {}};
    if (topic->kind == bus::TopicKind::kBoardOut) {
        if (!message.payload.starts_with('!')) return std::nullopt;
        line.text = message.payload.substr(1);
        while (!line.text.empty() && (line.text.back() == '\n' || line.text.back() == '\r'))
            line.text.pop_back();
        return line;
    }
    const bool of_agent = topic->kind == bus::TopicKind::kLog;
    if (!of_agent && topic->kind != bus::TopicKind::kServiceError) return std::nullopt;
    const auto document = model::parse_json(message.payload);
    if (!document || !document->is_object()) return std::nullopt;
    line.source = of_agent ? "agent" : std::string(topic->service);
    line.level = of_agent ? text_of(*document, "level") : "error";
    line.text = of_agent ? agent_text(*document) : error_text(*document);
    return line;
}

}  // namespace asip::cli
