// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <string>

#include "sim/world/track.hpp"

namespace asip::sim::world {
namespace {

constexpr std::size_t kMaxPathPoints = 10000;
constexpr double kPieceMm = 5;

/// Reads one path step by step; after a fault nothing more is read.
class SvgPath {
  public:
    explicit SvgPath(std::string_view text) : text_(text) {}

    Expected<std::vector<Point>> read() {
        while (fault_.empty() && skip_blanks() && points_.size() < kMaxPathPoints)
            step();
        if (points_.size() >= kMaxPathPoints) complain("more points than 10000");
        if (!fault_.empty()) return fail(fault_);
        for (auto& point : points_)
            point.y = -point.y;
        return points_;
    }

  private:
    void step() {
        const char letter = text_[at_];
        if (std::isalpha(static_cast<unsigned char>(letter)) != 0) {
            command_ = letter;
            ++at_;
        } else if (command_ == 0) {
            return complain("begins with M x,y");
        }
        if (closed_) return complain("goes on behind its Z; a track is one closed line");
        relative_ = std::islower(static_cast<unsigned char>(command_)) != 0;
        const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(command_)));
        if (points_.empty() && kind != 'M') return complain("begins with M x,y");
        if (kind == 'M') {
            if (!points_.empty()) return complain("has a second M; a track is one closed line");
            points_.push_back(pair());
            command_ = relative_ ? 'l' : 'L';  // what follows an M without a letter of its own
        } else if (kind == 'L') {
            points_.push_back(pair());
        } else if (kind == 'H') {
            points_.push_back({number() + (relative_ ? here().x : 0), here().y});
        } else if (kind == 'V') {
            points_.push_back({here().x, number() + (relative_ ? here().y : 0)});
        } else if (kind == 'C') {
            curve();
        } else if (kind == 'Z') {
            closed_ = true;
        } else {
            complain(fmt::format("has a {}; only M, L, H, V, C and Z are read", kind));
        }
    }

    void curve() {
        const auto a = here();
        const auto b = pair();
        const auto c = pair();
        const auto d = pair();
        const double size = length(b - a) + length(c - b) + length(d - c);
        const int pieces = static_cast<int>(std::min(500.0, std::ceil(size / kPieceMm))) + 1;
        for (int i = 1; i <= pieces && fault_.empty(); ++i) {
            const double t = static_cast<double>(i) / pieces, s = 1 - t;
            points_.push_back(s * s * s * a + 3 * s * s * t * b + 3 * s * t * t * c + t * t * t * d);
        }
    }

    Point here() const { return points_.back(); }

    Point pair() {
        const double x = number(), y = number();
        return relative_ && !points_.empty() ? here() + Point{x, y} : Point{x, y};
    }

    double number() {
        if (!fault_.empty()) return 0;
        skip_blanks();
        double value = 0;
        const auto* begin = text_.data() + at_;
        const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
        if (error != std::errc() || !(std::abs(value) <= 1e6)) {
            complain("lacks a number");
            return 0;
        }
        at_ += static_cast<std::size_t>(end - begin);
        return value;
    }

    /// False at the end.
    bool skip_blanks() {
        at_ = std::min(text_.find_first_not_of(" ,\t\r\n", at_), text_.size());
        return at_ < text_.size();
    }

    void complain(const std::string& what) {
        if (fault_.empty()) fault_ = fmt::format("the path {} (character {})", what, at_ + 1);
    }

    std::string_view text_;
    std::size_t at_ = 0;
    char command_ = 0;
    bool relative_ = false;
    bool closed_ = false;
    std::vector<Point> points_;
    std::string fault_;
};

}  // namespace

Expected<std::vector<Point>> read_svg_path(std::string_view path) {
    return SvgPath(path).read();
}

}  // namespace asip::sim::world
