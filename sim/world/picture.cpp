// SPDX-License-Identifier: Apache-2.0
#include "sim/world/picture.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace asip::sim::world {
namespace {

constexpr double kMarginMm = 120;
constexpr int kColours = 12;

struct Frame {
    Point low{1e9, 1e9}, high{-1e9, -1e9};
    void hold(Point p, double around) {
        low = {std::min(low.x, p.x - around), std::min(low.y, p.y - around)};
        high = {std::max(high.x, p.x + around), std::max(high.y, p.y + around)};
    }
};

Frame frame_of(const World& world) {
    Frame frame;
    for (const auto& point : world.track().line())
        frame.hold(point, kMarginMm);
    for (const auto& obstacle : world.obstacles())
        frame.hold(obstacle.at, obstacle.radius_mm);
    for (const auto& trail : world.trails())
        for (const auto& point : trail.points)
            frame.hold(point.at, 20);
    return frame;
}

int colour_of(double offset_mm, double off_mm) {
    return std::min(kColours - 1, static_cast<int>(std::abs(offset_mm) / (off_mm / 2) * kColours));
}

std::string hue(int colour) {
    return fmt::format("hsl({},85%,42%)", 130 - 130 * colour / (kColours - 1));
}

/// One polyline for each stretch of one colour.
std::string trail_of(const Trail& trail, double off_mm) {
    std::string text, points;
    int colour = -1;
    const auto finish = [&] {
        if (!points.empty())
            text += fmt::format("<polyline stroke=\"{}\" points=\"{}\"/>\n", hue(colour), points);
        points.clear();
    };
    for (std::size_t i = 0; i < trail.points.size(); ++i) {
        const auto& point = trail.points[i];
        const int next = colour_of(point.offset_mm, off_mm);
        if (point.jump || next != colour) {
            finish();
            if (!point.jump && i > 0)
                points = fmt::format("{:.1f},{:.1f} ", trail.points[i - 1].at.x, -trail.points[i - 1].at.y);
        }
        colour = next;
        points += fmt::format("{:.1f},{:.1f} ", point.at.x, -point.at.y);
    }
    finish();
    return text;
}

std::string rover_of(const World::State& rover, double radius) {
    const auto nose = beside(rover.pose, radius, 0);
    return fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{2:.1f}\"/><line x1=\"{0:.1f}\" y1=\"{1:.1f}\" "
        "x2=\"{3:.1f}\" y2=\"{4:.1f}\"/>\n",
        rover.pose.at.x, -rover.pose.at.y, radius, nose.x, -nose.y);
}

std::string line_of(const Track& track) {
    std::string points;
    for (const auto& point : track.line())
        points += fmt::format("{:.1f},{:.1f} ", point.x, -point.y);
    return points;
}

}  // namespace

std::string picture(const World& world) {
    const auto frame = frame_of(world);
    auto text = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{0:.0f} {1:.0f} {2:.0f} {3:.0f}\">\n"
        "<rect x=\"{0:.0f}\" y=\"{1:.0f}\" width=\"{2:.0f}\" height=\"{3:.0f}\" fill=\"#fff\"/>\n"
        "<polygon fill=\"none\" stroke=\"#d0d0d0\" stroke-linejoin=\"round\" stroke-width=\"{4:.1f}\" "
        "points=\"{5}\"/>\n<g fill=\"#999\">\n",
        frame.low.x, -frame.high.y, frame.high.x - frame.low.x, frame.high.y - frame.low.y,
        world.track().width_mm(), line_of(world.track()));
    for (const auto& obstacle : world.obstacles())
        text += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n", obstacle.at.x,
                            -obstacle.at.y, obstacle.radius_mm);
    text += "</g>\n<g fill=\"none\" stroke-width=\"3\" stroke-linejoin=\"round\">\n";
    const auto trails = world.trails();
    for (const auto& trail : trails)
        text += trail_of(trail, world.spec().off_mm);
    text += "</g>\n<g stroke=\"#c00\" stroke-width=\"4\">\n";
    for (const auto& trail : trails)
        for (const auto& bump : trail.bumps)
            text += fmt::format("<path d=\"M{:.1f} {:.1f}m-10-10l20 20m0-20l-20 20\"/>\n", bump.x, -bump.y);
    text += "</g>\n<g fill=\"none\" stroke=\"#235\" stroke-width=\"3\">\n";
    for (const auto& rover : world.rovers())
        text += rover_of(rover, world.spec().rover.radius_mm);
    return text + "</g>\n</svg>\n";
}

}  // namespace asip::sim::world
