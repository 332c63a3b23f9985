// SPDX-License-Identifier: Apache-2.0
#include "gateway/metrics/prometheus_text.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace asip::gateway::metrics {
namespace {

void append_escaped(std::string& text, std::string_view value) {
    for (const char c : value) {
        if (c == '\\' || c == '"') text += '\\';
        if (c == '\n')
            text += "\\n";
        else
            text += c;
    }
}

std::string number(double value) {
    if (std::isnan(value)) return "NaN";
    if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
    std::array<char, 32> digits;
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    return {digits.data(), end};
}

}  // namespace

std::string_view Exposition::content_type(Format format) {
    return format == Format::kOpenMetrics ? "application/openmetrics-text; version=1.0.0; charset=utf-8"
                                          : "text/plain; version=0.0.4; charset=utf-8";
}

void Exposition::family(std::string_view name, Type type, std::string_view unit, std::string_view help) {
    name_ = name;
    type_ = type;
    const bool open = format_ == Format::kOpenMetrics;
    std::string shown = name_;
    if (!open && type == Type::kCounter) shown += "_total";
    if (!open && type == Type::kInfo) shown += "_info";
    constexpr std::array<std::string_view, 4> kTypes{"counter", "gauge", "histogram", "info"};
    const auto word = !open && type == Type::kInfo ? "gauge" : kTypes[static_cast<std::size_t>(type)];
    head_ = "# TYPE ";
    head_.append(shown).append(" ").append(word).append("\n");
    if (open && !unit.empty()) head_.append("# UNIT ").append(shown).append(" ").append(unit).append("\n");
    head_.append("# HELP ").append(shown).append(" ").append(help).append("\n");
}

void Exposition::line(Labels labels, std::string_view more_name, std::string_view more_value, double value,
                      std::string_view suffix) {
    text_.append(std::exchange(head_, {}));
    text_.append(name_).append(suffix);
    char separator = '{';
    const auto label = [&](std::string_view name, std::string_view text) {
        text_ += separator;
        separator = ',';
        text_.append(name).append("=\"");
        append_escaped(text_, text);
        text_ += '"';
    };
    for (const auto& [name, text] : labels)
        label(name, text);
    if (!more_name.empty()) label(more_name, more_value);
    if (separator == ',') text_ += '}';
    text_.append(" ").append(number(value)).append("\n");
}

void Exposition::sample(Labels labels, double value, std::string_view suffix) {
    if (suffix.empty() && type_ == Type::kCounter) suffix = "_total";
    if (suffix.empty() && type_ == Type::kInfo) suffix = "_info";
    line(labels, {}, {}, value, suffix);
}

void Exposition::histogram(Labels labels, const std::vector<double>& bounds,
                           const std::vector<double>& buckets, double count, double sum) {
    for (std::size_t i = 0; i < bounds.size() && i < buckets.size(); ++i)
        line(labels, "le", number(bounds[i]), buckets[i], "_bucket");
    line(labels, "le", "+Inf", count, "_bucket");
    line(labels, {}, {}, count, "_count");
    line(labels, {}, {}, sum, "_sum");
}

std::string Exposition::finish() {
    if (format_ == Format::kOpenMetrics) text_ += "# EOF\n";
    return std::move(text_);
}

}  // namespace asip::gateway::metrics
