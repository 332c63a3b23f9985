// SPDX-License-Identifier: Apache-2.0
// Boards that browsers lend come and go while the process runs.
#include <algorithm>
#include <utility>

#include "agent/program/running_board.hpp"
#include "agent/program/supervisor.hpp"
#include "asip/link/cable_frames.hpp"

namespace asip::agent {

void Supervisor::serve_cables(Lending lending) {
    cables_ = std::make_unique<Cables>(
        io_, lending.folder,
        Cables::Handlers{[this, options = std::move(lending.options)](
                             const std::string& place, const std::string& port,
                             std::shared_ptr<const Lent> lent) { plugged(place, port, lent, options); },
                         [this](const std::string& place) { left(place); }});
}

std::shared_ptr<Supervisor::Board> Supervisor::find(const std::string& key) const {
    const auto found =
        std::find_if(boards_.begin(), boards_.end(), [&](const auto& each) { return each->plan.key == key; });
    return found == boards_.end() ? nullptr : *found;
}

// An agent that is there finds the board as it finds one that is plugged in again.
void Supervisor::plugged(const std::string& place, const std::string& port, std::shared_ptr<const Lent> lent,
                         AgentOptions options) {
    if (const auto board = find(place)) {
        board->wanted = true;
        if (board->agent) return tell_lender(*board);
        board->pause.reset();
        return start(*board, {});
    }
    options.serial = port;
    if (lent->pupils) options.bridge.name = std::string(link::kLentPrefix) + place;
    options.lent = std::move(lent);
    const auto number = free_number();
    for (auto& listen : options.listen)
        if (listen.address.port != 0)
            listen.address.port = static_cast<std::uint16_t>(listen.address.port + number);
    boards_.push_back(std::make_shared<Board>(io_, PlannedBoard{place, {}, std::move(options)}, several_));
    boards_.back()->number = number;
    start(*boards_.back(), {});
}

unsigned Supervisor::free_number() const {
    for (unsigned number = 0;; ++number)
        if (std::none_of(boards_.begin(), boards_.end(),
                         [number](const auto& each) { return each->number == number; }))
            return number;
}

void Supervisor::left(const std::string& place) {
    const auto board = find(place);
    if (!board) return;
    board->wanted = false;
    if (board->agent) return board->agent->stop();
    remove(*board);
}

void Supervisor::tell_lender(const Board& board) {
    if (!cables_ || !board.agent) return;
    if (const auto name = board.agent->name(); !name.empty()) cables_->named(board.plan.key, name);
}

}  // namespace asip::agent
