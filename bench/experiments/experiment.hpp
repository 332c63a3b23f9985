// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "bench/experiments/results.hpp"

namespace asip::experiments {

struct Setup {
    /// A firmware image that is measured beside ours; empty: none.
    std::string other_image;
    /// Few rounds and few settings: enough to see that everything works, too few for figures.
    bool quick = false;
};

/// One of the papers' experiments. Throws std::runtime_error with what to do where it cannot be carried out.
struct Experiment {
    std::string_view name;
    std::string_view about;
    std::vector<Results> (*run)(const Setup& setup);
};

std::vector<Results> footprint(const Setup& setup);
std::vector<Results> latency(const Setup& setup);
std::vector<Results> throughput(const Setup& setup);
std::vector<Results> two_board_switch(const Setup& setup);
std::vector<Results> discovery(const Setup& setup);
std::vector<Results> pid(const Setup& setup);

}  // namespace asip::experiments
