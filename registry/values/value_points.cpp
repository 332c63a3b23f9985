// SPDX-License-Identifier: Apache-2.0
#include "registry/values/value_points.hpp"

#include <algorithm>
#include <cmath>

namespace asip::registry {
namespace {

text::WallTime wall_of(std::int64_t milliseconds) {
    return text::WallTime(std::chrono::milliseconds(milliseconds));
}

/// Leaves out what says nothing new.
void append(std::vector<bus::ValuePoint>& points, bus::ValuePoint point) {
    const bool flat = !point.known || (point.min == point.max);
    if (!points.empty() && flat) {
        auto last = points.back();
        last.at = point.at;
        if (last == point) return;
    }
    points.push_back(point);
}

}  // namespace

ValuePoints::ValuePoints(std::int64_t from, std::int64_t to, std::size_t max)
    : from_(from), to_(to), max_(std::max<std::size_t>(1, max)) {}

void ValuePoints::add(std::int64_t from, std::int64_t to, double min, double mean, double max, double known) {
    from = std::max(from, from_);
    to = std::min(to, to_);
    if (from >= to || std::isnan(mean)) return;
    const Piece piece{from, to, min, mean, max, known};
    if (!cells_.empty()) return spread(piece);
    const bool in_order = pieces_.empty() || pieces_.back().to <= from;
    // A piece and the gap behind it are two points.
    if (in_order && pieces_.size() < max_ / 2) return pieces_.push_back(piece);
    cells_.resize(max_);
    for (const auto& each : pieces_)
        spread(each);
    pieces_.clear();
    spread(piece);
}

std::int64_t ValuePoints::cell_begin(std::size_t cell) const {
    return from_ + static_cast<std::int64_t>(static_cast<double>(to_ - from_) * static_cast<double>(cell) /
                                             static_cast<double>(max_));
}

void ValuePoints::spread(const Piece& piece) {
    const double width = static_cast<double>(to_ - from_) / static_cast<double>(max_);
    auto cell = static_cast<std::size_t>(static_cast<double>(piece.from - from_) / width);
    for (; cell < max_ && cell_begin(cell) < piece.to; ++cell) {
        const auto begin = std::max(piece.from, cell_begin(cell));
        const auto end = std::min(piece.to, cell_begin(cell + 1));
        if (begin >= end) continue;
        auto& into = cells_[cell];
        const double weight = static_cast<double>(end - begin) * piece.known;
        into.min = into.known > 0 ? std::min(into.min, piece.min) : piece.min;
        into.max = into.known > 0 ? std::max(into.max, piece.max) : piece.max;
        into.sum += piece.mean * weight;
        into.known += weight;
    }
}

std::vector<bus::ValuePoint> ValuePoints::of_cells() const {
    std::vector<bus::ValuePoint> points;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        const auto& cell = cells_[i];
        const auto at = wall_of(cell_begin(i));
        if (cell.known > 0)
            append(points,
                   {at, true, std::clamp(cell.sum / cell.known, cell.min, cell.max), cell.min, cell.max});
        else if (!points.empty())
            append(points, {at, false, 0, 0, 0});
    }
    return points;
}

std::vector<bus::ValuePoint> ValuePoints::points() {
    auto points = of_cells();
    std::int64_t until = from_;
    for (const auto& piece : pieces_) {
        if (!points.empty() && piece.from > until) append(points, {wall_of(until), false, 0, 0, 0});
        append(points, {wall_of(piece.from), true, piece.mean, piece.min, piece.max});
        until = piece.to;
    }
    if (!pieces_.empty() && until < to_) append(points, {wall_of(until), false, 0, 0, 0});
    return points;
}

}  // namespace asip::registry
