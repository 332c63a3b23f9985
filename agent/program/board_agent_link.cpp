// SPDX-License-Identifier: Apache-2.0
// The way to the board: opened, lost, and what comes on it.
#include <string>
#include <utility>

#include "agent/program/board_agent.hpp"

namespace asip::agent {
namespace {

// Longer than a boot loader and two rounds of asking at the start rate.
constexpr Duration kSilentAtStart = std::chrono::milliseconds(3500);

}  // namespace

void BoardAgent::link_received(std::string_view bytes) {
    const auto lines = options_.serial.empty() ? framing_.incoming(bytes) : std::string(bytes);
    if (!lines)
        return link_.reopen(framing_.kind() == LinkFraming::Kind::kFrames
                                ? "it sends frames, as the bridge of the Java programs does"
                                : "it sends plain lines");
    board_heard();
    with_bridge([&](Time now, Effects& out) { bridge_.receive(*lines, now, out); });
}

void BoardAgent::link_opened(const link::StreamOpened& opened) {
    framing_.opened();
    outage_.opened();
    model::LinkInfo info{options_.serial.empty() ? "tcp" : "serial", opened.name,
                         static_cast<int>(opened.baud)};
    with_bridge([&](Time now, Effects& out) {
        bridge_.link_up({opened.baud, opened.restarting}, std::move(info), now, out);
    });
    if (!opened.restarting && options_.reset == ResetPolicy::kIfSilent) board_silent_at_start();
}

void BoardAgent::link_failed(const link::StreamError& error) {
    using Kind = link::StreamError::Kind;
    const bool waiting_helps =
        error.kind == Kind::kNotThere || error.kind == Kind::kUnreachable || error.kind == Kind::kClosed;
    const bool announced = host_.goes_on && !options_.bridge.name.empty();
    if (outage_.first_attempt() && !waiting_helps && !announced) {
        log_.error(error.text, {});
        return finish(program::kExitBoard);
    }
    if (outage_.failed(error.kind, Clock::now()))
        log_.warning("board not reachable; waiting for it", {{"why", error.text}});
    if (bridge_.why_unreached() == error.text) return;
    with_bridge([&](Time now, Effects& out) {
        bridge_.unreached(waiting_helps               ? model::StateReason::kUnplugged
                          : error.kind == Kind::kBusy ? model::StateReason::kReleased
                                                      : model::StateReason::kNone,
                          error.text,
                          {options_.serial.empty() ? "tcp" : "serial",
                           options_.serial.empty() ? options_.tcp : options_.serial, 0},
                          now, out);
    });
    handlers_.on_changed();
}

void BoardAgent::link_lost(const link::StreamError& error) {
    reset_timer_.cancel();
    // Opened and closed without a byte from the board: the same as not opened.
    if (bridge_.session().counters().bytes_in == 0) link_failed(error);
    const bool pulled = options_.lent && !options_.lent->why_gone.empty();
    const auto& why = pulled ? options_.lent->why_gone : error.text;
    with_bridge([&](Time now, Effects& out) { bridge_.link_down(why, now, out); });
}

void BoardAgent::board_heard() {
    if (!ended() && outage_.heard()) log_.info("board reachable again", {});
}

void BoardAgent::board_silent_at_start() {
    reset_timer_.expires_after(kSilentAtStart);
    reset_timer_.async_wait([this](boost::system::error_code error) {
        if (error || ended() || bridge_.session().state() == session::BoardSession::State::kReady) return;
        if (link_.restart_board()) log_.info("board silent; restarting it by DTR", {});
    });
}

}  // namespace asip::agent
