// SPDX-License-Identifier: Apache-2.0
#include "sim/program/live_board.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace asip::sim {
namespace {

using json = nlohmann::ordered_json;
using namespace std::chrono_literals;

constexpr std::size_t kReadAtOnce = 512;
// With more bytes queued a sender waits, as it does for a slow wire.
constexpr std::size_t kMaxQueuedBytes = 1024;
// What a board that is further behind does not catch up with.
constexpr auto kMaxLag = 200ms;
// A board that catches up hears and answers its host on the way: a turn of the whole lag takes half a second
// where others have the processor.
constexpr auto kMaxTurn = 2ms;
// A host that has just sent something waits for the answer, and more may come.
constexpr auto kBusy = 5ms;
constexpr auto kHousekeeping = 1s;

}  // namespace

Expected<std::unique_ptr<LiveBoard>> LiveBoard::create(BoardFile file, Reporter& reporter) {
    auto board = Board::create(file.board);
    if (!board) return fail(board.error());
    std::unique_ptr<LiveBoard> live(new LiveBoard(std::move(file), reporter, std::move(*board)));
    if (auto opened = live->open_ports(); !opened) return fail(opened.error());
    return live;
}

LiveBoard::LiveBoard(BoardFile file, Reporter& reporter, std::unique_ptr<Board> board)
    : file_(std::move(file)), reporter_(reporter), board_(std::move(board)) {
    board_->on_change([this](const Change& change) { reporter_.changed(name(), change); });
    board_->on_byte([this](char byte) { to_host_.push_back(byte); });
    board_->on_reset([this](ResetCause cause) {
        if (cause == ResetCause::kPowerOn) return;
        happened("reset", json{{"cause", cause == ResetCause::kWatchdog ? "watchdog" : "external"}});
    });
}

std::vector<std::string> LiveBoard::part_names() const {
    std::vector<std::string> names;
    for (const auto& part : board_->parts())
        names.push_back(part->name());
    return names;
}

Pace LiveBoard::tick(Time now) {
    if (started_ == Time{}) started_ = now;
    if (!plugged_) return Pace::kIdle;
    // First up to now: bytes that are here have just come, and take their time on the wire from now on.
    const auto opening = notice_opening();
    const bool behind = run_towards(now);
    receive_from_ports(opening.readable);
    if (!to_host_.empty() || board_->sending() > 0) busy_until_ = now + kBusy;
    send_to_ports();
    if (now >= next_housekeeping_) {
        next_housekeeping_ = now + kHousekeeping;
        board_->save_eeprom();
        report_losses(now);
    }
    return behind ? Pace::kBehind : now < busy_until_ ? Pace::kBusy : Pace::kIdle;
}

void LiveBoard::add_waits(std::vector<pollfd>& waits) const {
    if (!plugged_) return;
    pty_.add_waits(waits, has_room());
    tcp_.add_waits(waits, has_room());
}

Pty::Events LiveBoard::notice_opening() {
    const auto events = pty_.look();
    if (events.opened) happened("opened", json::object());
    if ((events.opened || pty_in_use_) && !events.in_use) happened("closed", json::object());
    pty_in_use_ = events.in_use;
    const bool connected = tcp_.is_open() && tcp_.accept();
    if ((events.opened || connected) && file_.reset_on_open) board_->reset();
    follow_host_rate();
    return events;
}

// A TCP connection has no rate, so the line follows the board while one is there.
void LiveBoard::follow_host_rate() {
    board_->set_host_baud(pty_in_use_ && !tcp_.in_use() ? pty_.baud() : 0);
}

bool LiveBoard::has_room() const {
    return board_->sending() <= kMaxQueuedBytes;
}

void LiveBoard::receive_from_ports(bool pty_readable) {
    if (!has_room()) return;
    if (pty_in_use_ && pty_readable) {
        // A host that changes the rate waits until the bytes before it have left: those that are here are of
        // the new one.
        const auto bytes = pty_.read(kReadAtOnce);
        if (!bytes.empty()) follow_host_rate();
        board_->send(bytes);
    }
    if (tcp_.in_use()) board_->send(tcp_.read(kReadAtOnce));
}

bool LiveBoard::run_towards(Time now) {
    auto behind = started_at_ + (now - started_) - board_->now();
    if (behind > kMaxLag) {
        skipped_ += behind - kMaxLag;
        started_ += std::chrono::duration_cast<Duration>(behind - kMaxLag);
        behind = kMaxLag;
    }
    if (behind > 0ns) board_->run_for(std::min<SimTime>(behind, kMaxTurn));
    return behind > kMaxTurn;
}

void LiveBoard::report_losses(Time) {
    const auto& errors = board_->line_errors();
    const auto report = [&](std::uint64_t now, std::uint64_t& before, std::string_view event,
                            const char* direction) {
        if (now == before) return;
        happened(event, json{{"bytes", now - before}, {"direction", direction}});
        before = now;
    };
    report(errors.receive_overruns, reported_.receive_overruns, "overrun", "to-board");
    report(errors.garbled_to_board, reported_.garbled_to_board, "garbled", "to-board");
    report(errors.garbled_to_host, reported_.garbled_to_host, "garbled", "to-host");
    report(errors.cut_by_rate_change, reported_.cut_by_rate_change, "cut", "to-host");
    if (skipped_ > 0ns) {
        happened("behind", json{{"milliseconds", skipped_ / 1ms}});
        skipped_ = 0ns;
    }
    if (board_->alive() == reported_dead_) {
        reported_dead_ = !board_->alive();
        if (reported_dead_)
            happened("stopped", json{{"reason", "the firmware stopped the chip; reset starts it again"}});
    }
}

Expected<std::string> LiveBoard::command(std::string_view verb, std::string_view part,
                                         std::string_view argument, Time now) {
    busy_until_ = now + kBusy;
    if (verb == "list") return list();
    if (verb == "unplug" || verb == "replug") return plug(verb == "replug", now);
    if (verb == "reset") {
        if (!plugged_) return fail(name() + " is unplugged");
        board_->reset();
        return std::string();
    }
    if (verb == "load") {
        if (!plugged_) return fail(name() + " is unplugged");
        if (auto loaded = board_->load(argument); !loaded) return fail(loaded.error());
        happened("loaded", json{{"image", argument}});
        return std::string();
    }
    auto* target = board_->find_part(part);
    if (target == nullptr) return fail(fmt::format("{} has no part {}", name(), part));
    if (auto done = target->command(verb, argument); !done) return fail(done.error());
    return std::string();
}

Expected<std::string> LiveBoard::plug(bool in, Time now) {
    if (in == plugged_) return fail(name() + (in ? " is plugged in already" : " is unplugged already"));
    if (in) {
        if (auto opened = open_pty(); !opened) return fail(opened.error());
        started_ = now;
        started_at_ = board_->now();
        board_->power_cycle();
        happened("plugged", json{{"path", pty_.path()}});
    } else {
        happened("unplugged", json::object());
        board_->save_eeprom();
        close_ports();
    }
    plugged_ = in;
    return std::string();
}

std::string LiveBoard::list() const {
    auto text = fmt::format("{} {} {}\n", name(), board_->kind().name, shown_port());
    for (const auto& part : board_->parts())
        text += fmt::format("{}/{} {} {}\n", name(), part->name(), part->kind().name, part->state());
    return text;
}

}  // namespace asip::sim
