// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <concepts>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

/// One line an event, on standard error: a sentence and named fields.
///   2026-11-21T09:15:02.113Z info    board online  board=uno1 baud=500000
///   {"time":"2026-11-21T09:15:02.113Z","level":"info","text":"board online","board":"uno1","baud":"500000"}
namespace asip::program::log {

enum class Level { kTrace, kDebug, kInfo, kWarning, kError, kOff };
enum class Format { kText, kJson };

Expected<Level> parse_level(std::string_view name);    ///< trace, debug, info, warning (warn), error, off
std::string_view name_of(Level level);                 ///< what parse_level() reads
Expected<Format> parse_format(std::string_view name);  ///< text, json

/// Before anything is logged; the default is info and text. `program` stands in each JSON line.
void configure(Level level, Format format, std::string_view program = {});
bool enabled(Level level);

struct Field {
    std::string_view name;
    std::string value;

    Field(std::string_view field_name, std::string text) : name(field_name), value(std::move(text)) {}
    Field(std::string_view field_name, std::string_view text) : name(field_name), value(text) {}
    Field(std::string_view field_name, const char* text) : name(field_name), value(text) {}
    Field(std::string_view field_name, bool truth) : name(field_name), value(truth ? "true" : "false") {}
    template <class Number>
        requires(std::integral<Number> || std::floating_point<Number>)
    Field(std::string_view field_name, Number number) : name(field_name), value(std::to_string(number)) {}
};
using Fields = std::initializer_list<Field>;

void write(Level level, std::string_view text, Fields fields = {});
void write(Level level, std::string_view text, std::span<const Field> fields);
inline void trace(std::string_view text, Fields fields = {}) {
    write(Level::kTrace, text, fields);
}
inline void debug(std::string_view text, Fields fields = {}) {
    write(Level::kDebug, text, fields);
}
inline void info(std::string_view text, Fields fields = {}) {
    write(Level::kInfo, text, fields);
}
inline void warning(std::string_view text, Fields fields = {}) {
    write(Level::kWarning, text, fields);
}
inline void error(std::string_view text, Fields fields = {}) {
    write(Level::kError, text, fields);
}

}  // namespace asip::program::log
