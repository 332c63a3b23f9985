// SPDX-License-Identifier: Apache-2.0
#include "sim/program/pico_board.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace asip::sim {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMaxBytesAtOnce = 512;
// With more bytes queued a sender waits, as it does for a slow wire.
constexpr std::size_t kMaxBytesToBoard = 1024;
constexpr auto kAnswer = 10s;

nlohmann::json settings(const BoardFile& file) {
    nlohmann::json board{
        {"name", file.board.name}, {"image", file.board.image.string()}, {"parts", nlohmann::json::array()}};
    if (!file.board.eeprom.empty()) board["eeprom"] = file.board.eeprom.string();
    if (file.board.frequency != 0) board["frequency"] = file.board.frequency;
    for (const auto& part : file.board.parts) {
        auto one = part.settings.is_object() ? part.settings : nlohmann::json::object();
        one["kind"] = part.kind;
        if (!part.name.empty()) one["name"] = part.name;
        board["parts"].push_back(std::move(one));
    }
    return board;
}

}  // namespace

Expected<std::unique_ptr<LiveBoard>> PicoBoard::create(BoardFile file, Reporter& reporter) {
    auto process = PicoProcess::start(settings(file));
    if (!process) return fail(process.error());
    std::unique_ptr<PicoBoard> board(new PicoBoard(std::move(file), reporter, std::move(*process)));
    if (auto listed = board->ask("list", "", ""); !listed) return fail(listed.error());
    if (auto opened = board->open_ports(); !opened) return fail(opened.error());
    return board;
}

PicoBoard::PicoBoard(BoardFile file, Reporter& reporter, PicoProcess process)
    : LiveBoard(std::move(file), reporter), process_(std::move(process)) {}

std::vector<std::string> PicoBoard::part_names() const {
    return parts_;
}

Pace PicoBoard::tick(Time) {
    hear_all();
    if (!plugged_) return Pace::kIdle;
    const auto events = pty_.look();
    if (events.opened) happened("opened", nlohmann::ordered_json::object());
    if ((events.opened || pty_in_use_) && !events.in_use)
        happened("closed", nlohmann::ordered_json::object());
    pty_in_use_ = events.in_use;
    const bool connected = tcp_.is_open() && tcp_.accept();
    if ((events.opened || connected) && file_.reset_on_open) (void)ask("reset", "", "");
    if (has_room() && pty_in_use_ && events.readable) to_board_ += pty_.read(kMaxBytesAtOnce);
    if (has_room() && tcp_.in_use()) to_board_ += tcp_.read(kMaxBytesAtOnce);
    carry_to_board();
    carry_from_board();
    send_to_ports();
    return Pace::kIdle;
}

void PicoBoard::add_waits(std::vector<pollfd>& waits) const {
    // What has ended is readable for ever.
    if (process_.is_running()) waits.push_back({process_.output(), POLLIN, 0});
    if (!plugged_) return;
    if (process_.is_running()) waits.push_back({process_.line(), POLLIN, 0});
    pty_.add_waits(waits, has_room());
    tcp_.add_waits(waits, has_room());
}

bool PicoBoard::has_room() const {
    return to_board_.size() <= kMaxBytesToBoard;
}

void PicoBoard::carry_to_board() {
    if (to_board_.empty()) return;
    const auto taken = ::send(process_.line(), to_board_.data(), to_board_.size(), MSG_NOSIGNAL);
    if (taken > 0) to_board_.erase(0, static_cast<std::size_t>(taken));
}

void PicoBoard::carry_from_board() {
    std::array<char, 4096> buffer{};
    const auto count = ::recv(process_.line(), buffer.data(), buffer.size(), 0);
    if (count > 0) to_host_.append(buffer.data(), static_cast<std::size_t>(count));
}

void PicoBoard::hear_all() {
    const bool was_running = process_.is_running();
    while (const auto event = process_.read(0ms))
        heard(*event);
    if (was_running && !process_.is_running()) happened("stopped", {{"reason", process_.errors()}});
}

void PicoBoard::heard(const nlohmann::json& event) {
    time_ = std::chrono::duration_cast<SimTime>(std::chrono::duration<double>(event.value("time", 0.0)));
    if (event.contains("part")) {
        reporter_.changed(
            name(), {time_, event.value("part", ""), event.value("kind", ""), event.value("value", "")});
        return;
    }
    nlohmann::ordered_json details = nlohmann::ordered_json::object();
    for (const auto& [key, value] : event.items())
        if (key != "event" && key != "time") details[key] = value;
    happened(event.value("event", ""), details);
}

Expected<std::string> PicoBoard::ask(std::string_view verb, std::string_view part,
                                     std::string_view argument) {
    const auto id = ++asked_;
    process_.write({{"id", id}, {"verb", verb}, {"part", part}, {"argument", argument}});
    const auto end = Clock::now() + kAnswer;
    while (const auto answer = process_.read(std::chrono::duration_cast<std::chrono::milliseconds>(
               std::max<Duration>(end - Clock::now(), {})))) {
        if (!answer->contains("id")) {
            heard(*answer);
            continue;
        }
        if (answer->value("id", 0u) != id) continue;
        if (answer->contains("error")) return fail(answer->value("error", ""));
        if (answer->contains("parts")) parts_ = answer->value("parts", std::vector<std::string>());
        return answer->value("text", "");
    }
    return fail(process_.is_running() ? name() + " does not answer"
                                      : name() + " has stopped: the emulator has ended");
}

Expected<std::string> PicoBoard::command(std::string_view verb, std::string_view part,
                                         std::string_view argument, Time) {
    if (verb == "list") {
        auto listed = ask(verb, "", "");
        if (!listed) return fail(listed.error());
        return fmt::format("{} {} {}\n{}", name(), kPico, shown_port(), *listed);
    }
    if (verb == "unplug" || verb == "replug") return plug(verb == "replug");
    if (!plugged_ && part.empty()) return fail(name() + " is unplugged");
    return ask(verb, part, argument);
}

Expected<std::string> PicoBoard::plug(bool in) {
    if (in == plugged_) return fail(name() + (in ? " is plugged in already" : " is unplugged already"));
    if (in)
        if (auto opened = open_pty(); !opened) return fail(opened.error());
    if (auto done = ask(in ? "replug" : "unplug", "", ""); !done) return fail(done.error());
    if (in) {
        happened("plugged", {{"path", pty_.path()}});
    } else {
        happened("unplugged", nlohmann::ordered_json::object());
        to_board_.clear();
        close_ports();
    }
    plugged_ = in;
    return std::string();
}

}  // namespace asip::sim
