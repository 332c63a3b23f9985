// SPDX-License-Identifier: Apache-2.0
// Giving the line back as it was found, for the program that opens the port next.
#include "asip/protocol/request.hpp"
#include "asip/session/machine.hpp"

namespace asip::session {

namespace {

// What is under way is over by then, or its fence is lost.
constexpr Duration kUntilQuiet = std::chrono::milliseconds(150);
constexpr Duration kReturn = std::chrono::milliseconds(150);

}  // namespace

void Machine::leave(Leave how, Time now, Actions& out) {
    if (leaving_ || std::holds_alternative<Down>(state_)) return;
    leaving_ = Leaving{how == Leave::kAtOnce ? now : now + kUntilQuiet, false};
    std::vector<RequestEnd> ended;
    queue_.abandon_waiting(ended);
    report(ended, out);
    if (std::holds_alternative<Ready>(state_)) return pump(now, out);
    // While it is looked for it may be at any rate, and its answer is not waited for.
    if (known_) give_back(now, out);
    has_left();
}

void Machine::leave_once_quiet(Time now, Actions& out) {
    if (leaving_->asked) return;
    if (queue_.in_flight() && now < leaving_->until)
        return write(queue_.pump(now, [](const Request&) { return SelfReports{}; }), now, out);
    give_back(now, out);
    if (!leaving_->asked) has_left();
}

void Machine::give_back(Time now, Actions& out) {
    const auto& extensions = identity_.extensions;
    std::vector<std::string> lines;
    if (!std::holds_alternative<Ready>(state_))
        lines = wire_.switching_lines(false);
    else if (extensions.has(protocol::kChecksum))
        lines.push_back(protocol::set_checksum(false));
    const bool has_rate =
        wire_.has_rates() && (extensions.has(protocol::kLineRate) || !wire_.at_start_rate());
    if (has_rate) lines.push_back(protocol::set_line_rate(static_cast<int>(wire_.start_baud())));
    write(lines, now, out);
    leaving_->asked = has_rate;
    leaving_->until = now + kReturn;
}

void Machine::has_left() {
    state_ = Down{};
    there_ = false;
}

}  // namespace asip::session
