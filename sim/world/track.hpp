// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "sim/world/geometry.hpp"

namespace asip::sim::world {

/// A dark line on a light floor: a closed polyline of some width. Places on it are counted in millimetres
/// along its middle, from its first point.
class Track {
  public:
    /// At least three different points and a width of 1 to 200 mm; otherwise a sentence. The last point is
    /// joined to the first.
    static Expected<Track> create(std::vector<Point> line, double width_mm);

    const std::vector<Point>& line() const { return line_; }
    double width_mm() const { return width_; }
    double length_mm() const { return starts_.back(); }

    /// How much of a round spot lies on the line: 0 (none) to 1. `radius_mm` above 0.
    double darkness(Point centre, double radius_mm) const;

    /// The middle of the line, looking along it. `along` may be any number.
    Pose at(double along) const;

    struct Place {
        double along;   ///< millimetres, 0 up to length_mm()
        double offset;  ///< of the point from the middle of the line, positive on its left
    };
    /// The nearest place.
    Place nearest(Point point) const;
    /// The nearest within `reach` millimetres along the line from `along`: where a line crosses itself, the
    /// part that one is on.
    Place nearest(Point point, double along, double reach) const;

    /// `along` brought to 0 up to length_mm().
    double wrap(double along) const;

  private:
    Track(std::vector<Point> line, std::vector<double> starts, double width);
    /// The nearest point of one side: how far along the line, and the offset from it.
    Place nearest_of_side(Point point, std::size_t side) const;

    std::vector<Point> line_;
    std::vector<double> starts_;  // of each side, and the whole length behind them
    double width_;
};

/// The points of an SVG path: M, L, H, V, C and Z, absolute or relative, one closed line. Curves become
/// straight pieces of at most about 5 mm. SVG counts y downwards, so it is turned over. The error names the
/// place in the text.
Expected<std::vector<Point>> read_svg_path(std::string_view path);

}  // namespace asip::sim::world
