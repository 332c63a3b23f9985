// SPDX-License-Identifier: Apache-2.0
// Links of the board: rules that this agent executes as a client like others.
#include "agent/bridge/bridge.hpp"

namespace asip::agent {

namespace {
constexpr int kRounds = 4;  // a command that is refused at once makes another one due
}

void Bridge::on_message(const LinkRequest& request, Time now, Effects& out) {
    // A link to a pin is of no use without its mode.
    if (links_.request(request, now, out)) labels_.hurry(now);
}

void Bridge::source_message(const mqtt::Message& message, Time now, Effects& out) {
    links_.take(message, now);
    run_links(now, out);
}

void Bridge::sources_heard(bool heard, Time now) {
    heard ? links_.sources_connected(now) : links_.sources_disconnected(now);
}

void Bridge::link_kept(std::uint64_t ticket, const Expected<void>& result, Time now, Effects& out) {
    links_.kept(ticket, result, now, out);
    run_links(now, out);
}

Bridge::Standing Bridge::standing(Time now) const {
    Standing standing{values_.known().properties(), property::values_of(values_.known(), now),
                      session().accepts_requests() && found_};
    standing.values.head = {name(), announcer_ ? announcer_->session() : std::string(), 0};
    return standing;
}

std::uint64_t Bridge::standing_changes() const {
    return 2 * values_.changes() + (session().accepts_requests() && found_ ? 1 : 0);
}

void Bridge::source_stands(const Standing& source, Time now, Effects& out) {
    links_.local(source.properties, source.values, source.present, now);
    run_links(now, out);
}

void Bridge::source_gone(const std::string& board, Time now, Effects& out) {
    links_.local_gone(board, now);
    run_links(now, out);
}

void Bridge::run_links(Time now, Effects& out) {
    if (!links_.any() || leaving_) return;
    for (int round = 0; round < kRounds; ++round) {
        for (const auto& [link, outcome] : control_.take_outcomes())
            links_.finished(link, outcome);
        const auto commands = links_.run(now);
        if (commands.empty()) break;
        session::Actions actions;
        for (const auto& command : commands)
            control_.on_command(command, now, actions, out);
        perform(actions, now, out);
    }
    links_.tell(may_publish(), now, out);
    for (const auto& demand : links_.take_own_demands())
        if (const auto inbound = read(demand, now)) take(*inbound, now, out);
}

}  // namespace asip::agent
