// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/parsed_line.hpp"

namespace asip::protocol {

ParsedLine::ParsedLine(std::string line) : text_(std::move(line)) {
    keep(parse_line(text_), text_);
}

ParsedLine::ParsedLine(std::string_view line, const Message& message) : text_(line) {
    keep(message, line);
}

void ParsedLine::keep(const Message& message, std::string_view line) {
    std::string_view part;
    if (const auto* event = std::get_if<Event>(&message)) {
        kind_ = Kind::kEvent;
        service_ = event->service;
        tag_ = event->tag;
        part = event->body;
    } else if (const auto* error = std::get_if<ErrorReply>(&message)) {
        kind_ = Kind::kError;
        service_ = error->service;
        tag_ = error->tag;
        code_ = error->code;
        part = error->text;
    }
    if (part.empty()) return;
    part_at_ = static_cast<std::size_t>(part.data() - line.data());
    part_size_ = part.size();
}

}  // namespace asip::protocol
