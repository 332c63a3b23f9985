// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace asip::gateway::metrics {

/// Writes OpenMetrics 1.0, or the older text format of Prometheus. A family gets all its samples before the
/// next.
class Exposition {
  public:
    enum class Format { kOpenMetrics, kText };
    enum class Type { kCounter, kGauge, kHistogram, kInfo };
    using Labels = std::initializer_list<std::pair<std::string_view, std::string_view>>;

    explicit Exposition(Format format) : format_(format) {}

    /// `name` without `_total`; `unit` ("seconds", "bytes") is its ending, or empty. Not written without
    /// samples.
    void family(std::string_view name, Type type, std::string_view unit, std::string_view help);
    /// For the last family. `suffix` follows the name; "_total" comes by itself. Labels are escaped.
    void sample(Labels labels, double value, std::string_view suffix = {});
    /// `buckets[i]` counts all up to `bounds[i]`.
    void histogram(Labels labels, const std::vector<double>& bounds, const std::vector<double>& buckets,
                   double count, double sum);
    /// Once, last.
    std::string finish();

    static std::string_view content_type(Format format);

  private:
    void line(Labels labels, std::string_view more_name, std::string_view more_value, double value,
              std::string_view suffix);

    Format format_;
    Type type_ = Type::kGauge;
    std::string name_;
    std::string head_;  // of the family that was begun, until its first sample
    std::string text_;
};

}  // namespace asip::gateway::metrics
