// SPDX-License-Identifier: Apache-2.0
#include "agent/command/command_note.hpp"

#include "asip/bus/registry/items.hpp"

namespace asip::agent {

namespace {
constexpr std::size_t kMaxNoteText = 128;
constexpr std::string_view kUnnamed = "(unnamed)";
}  // namespace

void note_command(const Board& board, const CommandNote& note, Effects& out) {
    if (note.by.empty() && !(note.proven && note.outcome.succeeded())) return;
    bus::HistoryItem item;
    item.what = note.what;
    item.service = note.service;
    item.request = note.request.substr(0, kMaxNoteText);
    item.by = note.by.empty() ? kUnnamed : note.by;
    item.status = note.proven || !note.outcome.succeeded() ? bus::to_string(note.outcome.status) : "sent";
    const auto& why = note.outcome.reason.empty() ? note.outcome.error : note.outcome.reason;
    item.reason = why.substr(0, kMaxNoteText);
    mqtt::Message message;
    message.topic = board.topics.commands(board.name);
    bus::append_json(message.payload, item);
    out.notes.push_back(std::move(message));
}

}  // namespace asip::agent
