#pragma once
#include <string>
#include <utility>
#include <vector>

namespace asip::test {

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

}  // namespace asip::test
