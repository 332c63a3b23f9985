// SPDX-License-Identifier: Apache-2.0
#include "asip/program/log.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/text/printable.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::program::log {
namespace {

constexpr std::array<std::string_view, 6> kLevelNames = {"trace", "debug", "info", "warning", "error", "off"};

struct State {
    Level level = Level::kInfo;
    Format format = Format::kText;
    std::string program;
};

State& state() {
    static State instance;
    return instance;
}

std::string utc_now() {
    return text::iso_time(text::wall_now());
}

std::string field_text(std::string_view value) {
    const bool plain = !value.empty() && value.find_first_of(" \"\\=\t\r\n") == std::string_view::npos;
    if (plain) return text::escape_controls(value);
    std::string quoted;
    for (const char c : value) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += c;
    }
    return "\"" + text::escape_controls(quoted) + "\"";
}

std::string text_line(Level level, std::string_view text, std::span<const Field> fields) {
    std::string name(kLevelNames[static_cast<std::size_t>(level)]);
    name.resize(kLevelNames[static_cast<std::size_t>(Level::kWarning)].size(), ' ');  // the longest
    auto line = utc_now() + ' ' + name + ' ' + text::escape_controls(text);
    const char* separator = "  ";
    for (const auto& field : fields) {
        line.append(separator).append(field.name).append("=").append(field_text(field.value));
        separator = " ";
    }
    return line;
}

std::string json_text(std::string_view text) {
    return model::dump_json(nlohmann::json(text));
}

std::string json_line(Level level, std::string_view text, std::span<const Field> fields) {
    auto line = "{\"time\":" + json_text(utc_now()) +
                ",\"level\":" + json_text(kLevelNames[static_cast<std::size_t>(level)]);
    if (!state().program.empty()) line += ",\"program\":" + json_text(state().program);
    line += ",\"text\":" + json_text(text);
    for (const auto& field : fields)
        line += ',' + json_text(field.name) + ':' + json_text(field.value);
    return text::escape_json(line + '}');
}

}  // namespace

Expected<Level> parse_level(std::string_view name) {
    if (name == "warn") return Level::kWarning;
    const auto found = std::find(kLevelNames.begin(), kLevelNames.end(), name);
    if (found == kLevelNames.end()) {
        return fail("\"" + std::string(name) +
                    "\" is not a log level; use trace, debug, info, warning, error or off");
    }
    return static_cast<Level>(found - kLevelNames.begin());
}

Expected<Format> parse_format(std::string_view name) {
    if (name == "text") return Format::kText;
    if (name == "json") return Format::kJson;
    return fail("\"" + std::string(name) + "\" is not a log format; use text or json");
}

void configure(Level level, Format format, std::string_view program) {
    state().level = level;
    state().format = format;
    state().program = program;
}

bool enabled(Level level) {
    return level >= state().level && level != Level::kOff;
}

std::string_view name_of(Level level) {
    return kLevelNames[static_cast<std::size_t>(level)];
}

void write(Level level, std::string_view text, Fields fields) {
    write(level, text, std::span<const Field>(fields.begin(), fields.size()));
}

void write(Level level, std::string_view text, std::span<const Field> fields) {
    if (!enabled(level)) return;
    auto line =
        state().format == Format::kJson ? json_line(level, text, fields) : text_line(level, text, fields);
    line += '\n';
    // One write: lines of several programs that share a terminal or a file stay whole.
    std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace asip::program::log
