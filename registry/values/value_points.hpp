// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asip/bus/registry/items.hpp"

namespace asip::registry {

/// Makes at most so many points of how a value was within a time. Where fewer things happened, each is a
/// point; else each point stands for an equal part of the time. A point holds until the next; one without a
/// value begins a gap. Pure.
class ValuePoints {
  public:
    /// Milliseconds of the time of day, `from` < `to`.
    ValuePoints(std::int64_t from, std::int64_t to, std::size_t max);

    /// It was between `min` and `max` from `from` to `to`, and known for a part `known` of that. Pieces come
    /// in their order, but where the clock was set back.
    void add(std::int64_t from, std::int64_t to, double min, double mean, double max, double known = 1);
    /// All of them. To be called once.
    std::vector<bus::ValuePoint> points();

  private:
    struct Piece {
        std::int64_t from = 0, to = 0;
        double min = 0, mean = 0, max = 0;
        double known = 0;
    };
    struct Cell {
        double min = 0, max = 0, sum = 0, known = 0;
    };
    void spread(const Piece& piece);
    std::vector<bus::ValuePoint> of_cells() const;
    std::int64_t cell_begin(std::size_t cell) const;

    std::int64_t from_, to_;
    std::size_t max_;
    std::vector<Piece> pieces_;  // while each is a point
    std::vector<Cell> cells_;
};

}  // namespace asip::registry
