// SPDX-License-Identifier: Apache-2.0
#include "cli/record/recording.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/text/printable.hpp"

namespace asip::cli {
namespace {

using Kind = bus::TopicKind;

constexpr int kMaxRecordedDepth = 32;

struct RecordedKind {
    Kind kind;
    std::string_view word;
};
constexpr std::array kRecordedKinds{
    RecordedKind{Kind::kServiceOut, "value"}, RecordedKind{Kind::kServiceError, "error"},
    RecordedKind{Kind::kBoardOut, "line"},    RecordedKind{Kind::kServiceIn, "command"},
    RecordedKind{Kind::kBoardIn, "request"},  RecordedKind{Kind::kStop, "stop"},
    RecordedKind{Kind::kState, "state"},      RecordedKind{Kind::kDescription, "description"},
    RecordedKind{Kind::kStats, "stats"},      RecordedKind{Kind::kLog, "log"},
    RecordedKind{Kind::kBoardNames, "name"},  RecordedKind{Kind::kServiceNames, "service-name"},
};

std::string_view word_of(Kind kind) {
    for (const auto& one : kRecordedKinds) {
        if (one.kind == kind) return one.word;
    }
    return {};
}

std::optional<Kind> kind_of(std::string_view word) {
    for (const auto& one : kRecordedKinds) {
        if (one.word == word) return one.kind;
    }
    return std::nullopt;
}

bool has_controls(std::string_view text) {
    for (const unsigned char c : text) {
        if (c < 0x20 || c == 0x7f) return true;
    }
    return false;
}

/// Nothing has to be escaped: the case of nearly every line.
bool is_plain_ascii(std::string_view text) {
    for (const unsigned char c : text) {
        if (c < 0x20 || c >= 0x7f || c == '"' || c == '\\') return false;
    }
    return true;
}

std::string hex_of(std::string_view bytes) {
    std::string text;
    for (const unsigned char c : bytes)
        fmt::format_to(std::back_inserter(text), "{:02x}", c);
    return text;
}

std::optional<std::string> bytes_of(std::string_view hex) {
    std::string bytes;
    if (hex.size() % 2 != 0) return std::nullopt;
    for (std::size_t i = 0; i < hex.size(); i += 2) {
        unsigned value = 0;
        for (const char c : hex.substr(i, 2)) {
            const auto digit = std::string_view("0123456789abcdef").find(c);
            if (digit == std::string_view::npos) return std::nullopt;
            value = value * 16 + static_cast<unsigned>(digit);
        }
        bytes += static_cast<char>(value);
    }
    return bytes;
}

void append_payload(std::string& text, const std::string& payload) {
    const bool object = payload.starts_with('{') || payload.starts_with('[');
    if (object && !has_controls(payload) && model::json_depth_within(payload, kMaxRecordedDepth) &&
        nlohmann::json::accept(payload)) {
        text.append(",\"data\":").append(text::escape_json(payload));
    } else if (is_plain_ascii(payload)) {
        text.append(",\"text\":\"").append(payload).append("\"");
    } else if (const auto shown = model::dump_json(payload); nlohmann::json::parse(shown) == payload) {
        text.append(",\"text\":").append(text::escape_json(shown));
    } else {  // not UTF-8
        text.append(",\"hex\":\"").append(hex_of(payload)).append("\"");
    }
}

double seconds_of(std::chrono::microseconds at) {
    return std::chrono::duration<double>(at).count();
}

std::string text_member(const nlohmann::ordered_json& line, const char* name) {
    const auto found = line.find(name);
    return found != line.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::string recording_header(text::WallTime began) {
    return R"({"asip":"recording","version":1,"began":")" + text::iso_time(began) + "\"}\n";
}

Expected<text::WallTime> parse_recording_header(std::string_view line) {
    const auto document = model::parse_json(line);
    if (!document || !document->is_object() || document->value("asip", nlohmann::json()) != "recording")
        return fail("it does not begin as a recording does; asipctl record FILE makes one");
    if (document->value("version", nlohmann::json()) != 1)
        return fail("it was made by a later version of asipctl");
    const auto began = document->value("began", nlohmann::json());
    const auto time = began.is_string() ? text::parse_iso_time(began.get<std::string>()) : std::nullopt;
    if (!time) return fail("its first line does not say when it began");
    return *time;
}

bool is_recorded(bus::TopicKind kind) {
    return !word_of(kind).empty();
}

void append_recorded(std::string& text, const bus::TopicRef& topic, const mqtt::Message& message,
                     std::chrono::microseconds at) {
    // Names of a topic need no escapes; that of a board which announces its name is the payload.
    fmt::format_to(std::back_inserter(text), R"({{"at":{:.6f},"what":"{}")", seconds_of(at),
                   word_of(topic.kind));
    if (!topic.board.empty()) text.append(",\"board\":\"").append(topic.board).append("\"");
    if (!topic.service.empty()) text.append(",\"service\":\"").append(topic.service).append("\"");
    if (message.retain) text.append(",\"retained\":true");
    append_payload(text, message.payload);
    text.append("}\n");
}

Expected<std::optional<RecordedMessage>> parse_recorded(std::string_view line) {
    if (!model::json_depth_within(line, kMaxRecordedDepth + 1)) return fail("is nested too deeply");
    // Members keep their order: a payload is given back as it came, white space aside.
    const auto document = nlohmann::ordered_json::parse(line, nullptr, false);
    if (!document.is_object()) return fail("is not a JSON object");
    const auto what = text_member(document, "what");
    if (what == "gap") return std::optional<RecordedMessage>();
    const auto kind = kind_of(what);
    if (!kind) return fail("\"what\" is none of what is recorded: " + what);
    RecordedMessage message;
    message.kind = *kind;
    message.board = text_member(document, "board");
    message.service = text_member(document, "service");
    message.retained = document.value("retained", nlohmann::ordered_json()) == true;
    const auto at = document.value("at", nlohmann::ordered_json());
    if (!at.is_number() || !(at.get<double>() >= 0) || at.get<double>() > 1e10)
        return fail("\"at\" is not a number of seconds");
    message.at = std::chrono::microseconds(std::llround(at.get<double>() * 1e6));
    if (document.contains("data")) {
        message.payload =
            document["data"].dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    } else if (document.contains("hex")) {
        const auto bytes = bytes_of(text_member(document, "hex"));
        if (!bytes) return fail("\"hex\" is not hexadecimal");
        message.payload = *bytes;
    } else {
        message.payload = text_member(document, "text");
    }
    if (message.kind == Kind::kBoardNames) message.board = message.payload;
    if (!model::valid_board_name(message.board)) return fail("\"board\" is not the name of a board");
    const bool of_service =
        *kind == Kind::kServiceOut || *kind == Kind::kServiceError || *kind == Kind::kServiceIn;
    if (of_service && !model::valid_name(message.service)) return fail("\"service\" is not the name of one");
    return std::optional(std::move(message));
}

std::string topic_of(const bus::Topics& topics, const RecordedMessage& message, const std::string& board) {
    switch (message.kind) {
        case Kind::kServiceOut:
            return topics.service_out(board, message.service);
        case Kind::kServiceError:
            return topics.service_error(board, message.service);
        case Kind::kServiceIn:
            return topics.service_in(board, message.service);
        case Kind::kBoardOut:
            return topics.board_out(board);
        case Kind::kBoardIn:
            return topics.board_in(board);
        case Kind::kStop:
            return topics.stop(board);
        case Kind::kState:
            return topics.state(board);
        case Kind::kDescription:
            return topics.description(board);
        case Kind::kStats:
            return topics.stats(board);
        case Kind::kLog:
            return topics.log(board);
        case Kind::kServiceNames:
            return topics.service_names(board);
        default:
            return topics.board_names();
    }
}

std::string gap_line(std::chrono::microseconds at, std::string_view why) {
    return fmt::format(R"({{"at":{:.6f},"what":"gap","text":{}}})", seconds_of(at),
                       model::dump_json(nlohmann::json(why))) +
           "\n";
}

}  // namespace asip::cli
