// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {

/// A bridge whose board and broker are there, with nothing published or executed yet.
struct OnlineBridge : testing::Test {
    OnlineBridge() {
        bench.go_online();
        bench.published.clear();
        bench.board.executed.clear();
    }
    BridgeBench bench;
};

}  // namespace asip::agent
