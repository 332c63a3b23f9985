// SPDX-License-Identifier: Apache-2.0
#include "bench/experiments/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace asip::experiments {
namespace {

constexpr double kLeft = 70, kTop = 50, kWidth = 560, kHeight = 300;
constexpr std::array kColours = {"#1b6ca8", "#c2571a", "#3a7d34", "#7b3fa0", "#a0831b", "#8a2846"};

/// A round number of which four to nine fit below `most`.
double tick_for(double most) {
    const double power = std::pow(10, std::floor(std::log10(most)));
    for (const double step : {0.1, 0.2, 0.25, 0.5, 1.0})
        if (most / (power * step) <= 9) return power * step;
    return power;
}

struct Axes {
    double x_most = 1, y_most = 1;

    double x(double value) const { return kLeft + value / x_most * kWidth; }
    double y(double value) const { return kTop + kHeight - value / y_most * kHeight; }
};

Axes axes_for(const std::vector<Plot::Curve>& curves) {
    Axes axes{1e-9, 1e-9};
    for (const auto& curve : curves) {
        for (const auto& [x, y] : curve.points) {
            axes.x_most = std::max(axes.x_most, x * 1.05);
            axes.y_most = std::max(axes.y_most, y * 1.1);
        }
        for (const double x : curve.failed)
            axes.x_most = std::max(axes.x_most, x * 1.05);
    }
    return axes;
}

std::string escaped(const std::string& text) {
    std::string all;
    for (const char c : text)
        all += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    return all;
}

/// Its beginning.
std::string document(double height, const std::string& title, double left) {
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 800 {0}\" font-family=\"sans-serif\" "
        "font-size=\"12\">\n<rect width=\"800\" height=\"{0}\" fill=\"#fff\"/>\n"
        "<text x=\"{1}\" y=\"24\" font-size=\"15\">{2}</text>\n",
        height, left, escaped(title));
}

std::string grid(const Axes& axes) {
    std::string text;
    for (double x = 0; x <= axes.x_most; x += tick_for(axes.x_most))
        text += fmt::format(
            "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3}\" "
            "text-anchor=\"middle\">{4:g}</text>\n",
            axes.x(x), kTop, kTop + kHeight, kTop + kHeight + 18, x);
    for (double y = 0; y <= axes.y_most; y += tick_for(axes.y_most))
        text += fmt::format(
            "<path d=\"M{0} {1:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" "
            "text-anchor=\"end\">{5:g}</text>\n",
            kLeft, axes.y(y), kLeft + kWidth, kLeft - 8, axes.y(y) + 4, y);
    return text;
}

std::string curve_of(const Plot::Curve& curve, const Axes& axes, std::size_t index) {
    std::string points, text;
    for (const auto& [x, y] : curve.points)
        points += fmt::format("{:.1f},{:.1f} ", axes.x(x), axes.y(y));
    const auto* colour = kColours[index % kColours.size()];
    text += fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"2\" points=\"{}\"/>\n", colour,
                        points);
    for (const double x : curve.failed)
        text +=
            fmt::format("<path d=\"M{:.1f} {}m-5-5l10 10m0-10l-10 10\" stroke=\"{}\" stroke-width=\"2\"/>\n",
                        axes.x(x), kTop + 8 + 14 * static_cast<double>(index), colour);
    return text + fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\">{}</text>\n", kLeft + kWidth + 12,
                              kTop + 14 + 18 * static_cast<double>(index), colour, escaped(curve.name));
}

}  // namespace

std::string Plot::svg() const {
    const auto axes = axes_for(curves);
    auto text = document(410, title, kLeft) +
                fmt::format(
                    "<text x=\"{2}\" y=\"{3}\" text-anchor=\"middle\">{0}</text>\n<text x=\"{4}\" y=\"42\" "
                    "text-anchor=\"start\">{1}</text>\n",
                    x_label, y_label, kLeft + kWidth / 2, kTop + kHeight + 42, kLeft);
    text += grid(axes);
    for (std::size_t i = 0; i < curves.size(); ++i)
        text += curve_of(curves[i], axes, i);
    return text + "</svg>\n";
}

std::string Bars::svg() const {
    constexpr double kNames = 300, kLongest = 400, kStep = 24;
    double most = 1e-9;
    for (const auto& [name, value] : bars)
        most = std::max(most, value);
    auto text = document(60 + kStep * static_cast<double>(bars.size()), title, 20);
    double y = 44;
    for (const auto& [name, value] : bars) {
        text += fmt::format(
            "<text x=\"{0}\" y=\"{1}\" text-anchor=\"end\">{2}</text><rect x=\"{3}\" y=\"{4}\" "
            "width=\"{5:.1f}\" "
            "height=\"16\" fill=\"{6}\"/><text x=\"{7:.1f}\" y=\"{1}\">{8:.5g}</text>\n",
            kNames - 8, y + 12, escaped(name), kNames, y, value / most * kLongest, kColours[0],
            kNames + value / most * kLongest + 6, value);
        y += kStep;
    }
    return text + "</svg>\n";
}

}  // namespace asip::experiments
