// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tests/cluster/history.hpp"

namespace cluster {

/// A board at the end of a link to its agent. It tells what it executed by the token in each command.
class Board {
  public:
    /// The token, and when it was seen.
    using OnExecuted = std::function<void(std::size_t token, Millis at)>;

    Board() = default;
    virtual ~Board() = default;
    Board(const Board&) = delete;
    Board& operator=(const Board&) = delete;

    /// Options of asip-agent that name the link.
    virtual std::vector<std::string> link() const = 0;
    /// The request that carries a token, for each token another.
    virtual std::string request(std::size_t token) const = 0;

    virtual void cut() = 0;   ///< the link ends, and there is no new one
    virtual void plug() = 0;  ///< it is back, and the board has just started
};

}  // namespace cluster
