// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace asip::experiments {

/// Some curves over one axis. Points of a curve without a value (the drive failed) are drawn as a cross at
/// the upper edge.
struct Plot {
    struct Curve {
        std::string name;
        std::vector<std::pair<double, double>> points;
        std::vector<double> failed;  ///< places on the axis
    };
    std::string title;
    std::string x_label;
    std::string y_label;
    std::vector<Curve> curves;

    /// An SVG document.
    std::string svg() const;
};

/// One bar for each name, from above, with its value.
struct Bars {
    std::string title;
    std::vector<std::pair<std::string, double>> bars;

    /// An SVG document.
    std::string svg() const;
};

}  // namespace asip::experiments
