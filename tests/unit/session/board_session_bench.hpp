// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include "tests/unit/session/scripted_board.hpp"

namespace asip::session {

inline SessionOptions no_step_up() {
    SessionOptions options;
    options.max_baud = 0;
    return options;
}

/// With a board that speaks ASIP 0.4.
struct OldBoard : testing::Test {
    OldBoard() { bench.board.extensions = false; }
    Bench bench;
};

enum class Generation { kPlain04, kExtended, kVerified };

/// With a board of each generation.
class EachGeneration : public testing::TestWithParam<Generation> {
  protected:
    EachGeneration() {
        bench.board.extensions = GetParam() != Generation::kPlain04;
        bench.board.verified_fences = GetParam() == Generation::kVerified;
    }
    Bench bench;
};

}  // namespace asip::session
