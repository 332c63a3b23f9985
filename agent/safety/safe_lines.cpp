// SPDX-License-Identifier: Apache-2.0
#include "agent/safety/safe_lines.hpp"

namespace asip::agent {

bool SafeLines::on_finished(const session::Finished& end, std::vector<Done>& done) {
    using session::Ending;
    const auto request = requests_.find(end.id);
    if (request == requests_.end()) return false;
    const std::string line = std::move(request->second);
    requests_.erase(request);
    const auto pending = pending_.find(line);
    if (pending == pending_.end()) return true;
    pending->second.request = 0;
    const bool refused = end.ending == Ending::kBoardError;
    const bool executed =
        end.ending == Ending::kExecuted || end.ending == Ending::kUnproven || end.ending == Ending::kNoValue;
    pending->second.refused = refused ? pending->second.refused + 1 : 0;
    if (!executed && pending->second.refused < kRefusals) return true;
    done.push_back({line, std::move(pending->second.sent), executed, end.code, end.text});
    pending_.erase(pending);
    return true;
}

void SafeLines::clear() {
    pending_.clear();
    requests_.clear();
}

}  // namespace asip::agent
