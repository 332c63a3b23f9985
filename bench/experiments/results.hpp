// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "bench/experiments/plot.hpp"

namespace asip::experiments {

/// What an experiment found: a table, and plots of it.
struct Results {
    std::string name;  ///< of its files: NAME.csv, NAME.svg, or NAME-PLOT.svg for each where there are
                       ///< several
    std::string title;
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;  ///< each as long as `columns`; an empty cell: no value
    /// How the set-up differs from the published one, and where recorded values come from.
    std::vector<std::string> notes;
    struct Picture {
        std::string name;
        std::string svg;
    };
    std::vector<Picture> pictures;

    /// For a person, on standard output.
    void print() const;
    /// Throws std::runtime_error if a file cannot be written.
    void save(const std::filesystem::path& folder) const;
    std::string csv() const;
};

struct Summary {
    double mean, median, p99, max;
};
/// Summary of at least one sample, in any order and unit.
Summary summary(std::vector<double> samples);

}  // namespace asip::experiments
