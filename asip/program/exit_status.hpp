// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::program {

/// All programs have these; documented, so never renumbered.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailure = 1;       ///< what was asked did not succeed
inline constexpr int kExitUsage = 2;         ///< usage, bad option or bad input file
inline constexpr int kExitBroker = 3;        ///< broker not reachable, or it refused us
inline constexpr int kExitNoAnswer = 4;      ///< nothing answered in time
inline constexpr int kExitBoard = 5;         ///< port busy, no permission, not an ASIP board
inline constexpr int kExitNameConflict = 6;  ///< another living program holds the name

}  // namespace asip::program
