// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "tests/truth/plan.hpp"

namespace truth {

/// What a client wants of the board.
struct Command {
    unsigned client = 0;
    std::string line;
    bool prove = true;
    char answer_tag = 0;           ///< it asks for a value: tag of the event that brings it
    Micros lasts = 0;              ///< from its submission to its deadline
    std::optional<Effect> effect;  ///< what executing it does to the board
    Micros hold = 0;               ///< it is undone after so long, unless it is renewed; 0: it is not
    std::string safe;              ///< the request that undoes it
    bool urgent = false;           ///< it makes the board safe
};

/// Draws the commands of a history. Requests of service `W` have a number of their own each, so that an
/// execution says which command it was.
class CommandSource {
  public:
    explicit CommandSource(Dice& dice) : dice_(dice) {}
    Command draw(unsigned client, const ClientPlan& plan);

  private:
    Command bad();
    Command mark(std::size_t length);
    Command pin();
    Command question();
    Command setting();

    Dice& dice_;
    int next_mark_ = 0;
};

}  // namespace truth
