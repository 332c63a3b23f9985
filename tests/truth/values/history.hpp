// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

/// Random histories of how a board stands: commands of several programs, levels and distances, restarts of
/// the board, broker and gateway, lost lines and readers, in simulated time. A real agent and a real gateway
/// stand between a scripted board and what is asked; each view is compared with what the board did.
namespace truth::values {

struct End {
    std::string failure;             ///< empty: nothing was wrong
    std::vector<std::string> trace;  ///< what happened, where it was asked for
    std::uint64_t looks = 0;         ///< values that were compared
    std::uint64_t known = 0;         ///< of these, values that a view knew
    std::uint64_t reads = 0;
};

End run_history(std::uint64_t seed, bool traced);
/// A lamp that is on, and so many reads beside other commands: it is never dark.
End run_lamp(std::uint64_t seed, unsigned reads);

}  // namespace truth::values
