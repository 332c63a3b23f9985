// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace truth {

World::World(Setting setting)
    : dice_(std::move(setting.dice)),
      plan_(std::move(setting.plan)),
      trace_(setting.trace),
      note_([this](const std::string& text) { note(text); }),
      ledger_(setting.calm, plan_.extensions, note_),
      to_board_(plan_.to_board, dice_, fault_of_line(true)),
      to_host_(plan_.to_host, dice_, fault_of_line(false)),
      board_(plan_.extensions     ? firmware_with_extensions()
             : plan_.parser_of_04 ? firmware_with_parser_of_04()
                                  : firmware_of_04(),
             to_board_, to_host_, dice_, plan_.board_pass, plan_.idle_pass, !plan_.extensions, reports()),
      agent_(plan_, dice_, ledger_, to_board_, note_) {}

void World::note(const std::string& text) {
    if (trace_) lines_.push_back(fmt::format("{:10.6f} {}", static_cast<double>(now_) * 1e-6, text));
}

Wire::OnFault World::fault_of_line(bool to_board) {
    return [this, to_board](Fault fault, const WireByte& byte) {
        if (trace_ && fault != Fault::kStalled)
            note(fmt::format("  {} {}: {:#04x}", to_board ? "to the board" : "to the host", to_string(fault),
                             static_cast<unsigned char>(byte.value)));
        on_fault(byte);
        ledger_.fault(to_board, fault, byte, now_);
    };
}

BoardModel::Reports World::reports() {
    return {[this](BoardRead read) {
                if (trace_) note("    board reads " + read.text);
                for (const Effect& effect : read.effects)
                    if (trace_)
                        note(fmt::format("    board does {} {} {}", static_cast<int>(effect.kind),
                                         effect.subject, effect.value));
                on_read(read);
                ledger_.board_read(std::move(read));
            },
            [this](std::uint32_t line, std::string text) {
                if (trace_) note("    board says " + text);
                ledger_.board_sent(line, std::move(text), now_);
            },
            [this](Fault fault, const WireByte& byte) {
                if (trace_) note(fmt::format("  board: {}", to_string(fault)));
                ledger_.fault(true, fault, byte, now_);
            },
            [this](const char* state) {
                note(state);
                if (std::string_view(state) == BoardModel::kOff) on_board_off();
            }};
}

Micros World::next(Micros other) const {
    Micros next = std::min({agent_.next(), board_.next(), link_back_at_, other});
    if (!to_host_.empty()) next = std::min(next, to_host_.next());
    if (next_incident_ < incidents_.size()) next = std::min(next, incidents_[next_incident_].at);
    return std::max(next, now_);
}

void World::pass() {
    while (next_incident_ < incidents_.size() && incidents_[next_incident_].at <= now_)
        happen(incidents_[next_incident_++]);
    if (link_back_at_ <= now_) link_back();
    while (board_.next() <= now_)
        board_.run(now_);
    deliver();
    agent_.tick(now_);
}

void World::deliver() {
    std::string bytes;
    while (!to_host_.empty() && to_host_.next() <= now_) {
        WireByte byte = to_host_.take();
        if (byte.baud != agent_.baud()) {
            ledger_.fault(false, Fault::kNoise, byte, now_);
            byte.value = static_cast<char>(dice_.below(256));
        }
        bytes += byte.value;
    }
    if (bytes.empty() || !is_link_up()) return;
    if (trace_) note("< " + bytes);
    agent_.receive(bytes, now_);
}

void World::happen(const Incident& incident) {
    if (!is_link_up()) return;
    note(to_string(incident.kind));
    ++ledger_.counts.incidents;
    on_incident(incident);
    switch (incident.kind) {
        case Incident::Kind::kBoardReset:
            return board_.restart(now_, now_ + plan_.boot);
        case Incident::Kind::kHang:
            return board_.hang(now_, now_ + incident.lasts);
        case Incident::Kind::kDie:
            return board_.restart(now_, now_ + incident.lasts + plan_.boot);
        case Incident::Kind::kUnplug:
            agent_.link_down(now_);
            board_.restart(now_, kNever);
            to_board_.clear(now_);
            to_host_.clear(now_);
            link_back_at_ = now_ + incident.lasts;
            return;
        case Incident::Kind::kReopen:
            agent_.link_down(now_);
            to_board_.clear(now_);
            to_host_.clear(now_);
            return link_back();
        case Incident::Kind::kAgentRestart:
            return agent_.restart(now_);
    }
}

void World::link_back() {
    link_back_at_ = kNever;
    board_.restart(now_, now_ + plan_.boot);
    agent_.link_up(true, now_);
}

}  // namespace truth
