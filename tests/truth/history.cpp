// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/history.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tests/truth/agent.hpp"
#include "tests/truth/board_model.hpp"

namespace truth {

namespace {

class History {
  public:
    History(std::uint64_t seed, bool trace)
        : dice_(seed),
          plan_(draw_plan(seed, dice_)),
          trace_(trace),
          note_([this](const std::string& text) { note(text); }),
          ledger_(plan_.calm(), plan_.extensions, note_),
          to_board_(plan_.to_board, dice_, on_fault(true)),
          to_host_(plan_.to_host, dice_, on_fault(false)),
          board_(plan_.extensions ? firmware_with_extensions() : firmware_of_04(), to_board_, to_host_, dice_,
                 plan_.board_pass, plan_.idle_pass, !plan_.extensions, reports()),
          agent_(plan_, dice_, ledger_, to_board_, note_),
          commands_(dice_) {}

    HistoryEnd run();

  private:
    void note(const std::string& text) {
        if (trace_) lines_.push_back(fmt::format("{:10.6f} {}", static_cast<double>(now_) * 1e-6, text));
    }
    Wire::OnFault on_fault(bool to_board);
    BoardModel::Reports reports();
    void board_read(BoardRead read);
    Micros next() const;
    void deliver();
    void clients();
    void incidents();
    void happen(const Incident& incident);
    void link_back();

    Dice dice_;
    Plan plan_;
    bool trace_;
    Micros now_ = 0;
    std::vector<std::string> lines_;
    Ledger::Note note_;
    Ledger ledger_;
    Wire to_board_, to_host_;
    BoardModel board_;
    Agent agent_;
    CommandSource commands_;
    std::vector<Micros> client_next_;
    std::size_t next_incident_ = 0;
    Micros link_back_at_ = kNever;
};

Wire::OnFault History::on_fault(bool to_board) {
    return [this, to_board](Fault fault, const WireByte& byte) {
        if (trace_ && fault != Fault::kStalled)
            note(fmt::format("  {} {}: {:#04x}", to_board ? "to the board" : "to the host", to_string(fault),
                             static_cast<unsigned char>(byte.value)));
        ledger_.fault(to_board, fault, byte, now_);
    };
}

BoardModel::Reports History::reports() {
    return {[this](BoardRead read) { board_read(std::move(read)); },
            [this](std::uint32_t line, std::string text) {
                if (trace_) note("    board says " + text);
                ledger_.board_sent(line, std::move(text), now_);
            },
            [this](Fault fault, const WireByte& byte) {
                if (trace_) note(fmt::format("  board: {}", to_string(fault)));
                ledger_.fault(true, fault, byte, now_);
            },
            [this](const char* state) { note(state); }};
}

void History::board_read(BoardRead read) {
    if (trace_) {
        note("    board reads " + read.text);
        for (const Effect& effect : read.effects)
            note(fmt::format("    board does {} {} {}", static_cast<int>(effect.kind), effect.subject,
                             effect.value));
    }
    ledger_.board_read(std::move(read));
}

Micros History::next() const {
    Micros next = std::min({agent_.next(), board_.next(), link_back_at_});
    if (!to_host_.empty()) next = std::min(next, to_host_.next());
    for (const Micros client : client_next_)
        next = std::min(next, client);
    if (next_incident_ < plan_.incidents.size()) next = std::min(next, plan_.incidents[next_incident_].at);
    return std::max(next, now_);
}

void History::deliver() {
    std::string bytes;
    while (!to_host_.empty() && to_host_.next() <= now_) {
        WireByte byte = to_host_.take();
        if (byte.baud != agent_.baud()) {
            ledger_.fault(false, Fault::kNoise, byte, now_);
            byte.value = static_cast<char>(dice_.below(256));
        }
        bytes += byte.value;
    }
    if (bytes.empty() || link_back_at_ != kNever) return;
    if (trace_) note("< " + bytes);
    agent_.receive(bytes, now_);
}

void History::clients() {
    for (std::size_t i = 0; i < client_next_.size(); ++i) {
        if (client_next_[i] > now_) continue;
        const ClientPlan& client = plan_.clients[i];
        const auto count = dice_.chance(client.burst) ? dice_.between(2, 12) : 1;
        for (auto k = count; k > 0; --k)
            agent_.submit(commands_.draw(static_cast<unsigned>(i + 1), client), now_);
        const Micros next = now_ + dice_.between(1, 2 * client.pause);
        client_next_[i] = next < plan_.active ? next : kNever;
    }
}

void History::incidents() {
    while (next_incident_ < plan_.incidents.size() && plan_.incidents[next_incident_].at <= now_)
        happen(plan_.incidents[next_incident_++]);
    if (link_back_at_ <= now_) link_back();
}

void History::happen(const Incident& incident) {
    if (link_back_at_ != kNever) return;
    note(to_string(incident.kind));
    ++ledger_.counts.incidents;
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

void History::link_back() {
    link_back_at_ = kNever;
    board_.restart(now_, now_ + plan_.boot);
    agent_.link_up(true, now_);
}

HistoryEnd History::run() {
    std::sort(plan_.incidents.begin(), plan_.incidents.end(),
              [](const Incident& a, const Incident& b) { return a.at < b.at; });
    if (trace_) lines_.push_back(describe(plan_));
    ledger_.counts.histories = 1;
    for (const ClientPlan& client : plan_.clients)
        client_next_.push_back(dice_.between(0, 2 * client.pause));
    const bool boots = dice_.chance(0.5);
    board_.restart(0, boots ? plan_.boot : 0);
    if (!boots) board_.run(0);
    agent_.link_up(boots, 0);
    while (!ledger_.failed()) {
        now_ = next();
        if (now_ > plan_.active && (ledger_.open() == 0 || now_ > ledger_.last_deadline() + 2 * kMillisecond))
            break;
        incidents();
        while (board_.next() <= now_)
            board_.run(now_);
        deliver();
        agent_.tick(now_);
        clients();
    }
    ledger_.finish();
    return {ledger_.counts, ledger_.failure(), std::move(lines_)};
}

}  // namespace

HistoryEnd run_history(std::uint64_t seed, bool trace) {
    return History(seed, trace).run();
}

}  // namespace truth
