// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "asip/expected.hpp"

namespace asip::gateway::exports::sparkplug {

/// The numbers of the wire, as far as our metrics use them.
enum class DataType : std::uint32_t {
    kUnknown = 0,
    kInt8 = 1,
    kInt16 = 2,
    kInt32 = 3,
    kInt64 = 4,
    kUInt8 = 5,
    kUInt16 = 6,
    kUInt32 = 7,
    kUInt64 = 8,
    kFloat = 9,
    kDouble = 10,
    kBoolean = 11,
    kString = 12,
    kDateTime = 13,
    kText = 14,
};

/// monostate: null, or of a kind that is not read.
using Value = std::variant<std::monostate, std::int64_t, double, bool, std::string>;

struct Property {
    std::string key;
    Value value;
    friend bool operator==(const Property&, const Property&) = default;
};

struct Metric {
    std::string name{};
    std::optional<std::uint64_t> alias{};
    std::optional<std::uint64_t> timestamp{};  ///< ms since 1970
    DataType type = DataType::kUnknown;
    Value value{};
    std::vector<Property> properties{};
    friend bool operator==(const Metric&, const Metric&) = default;
};

struct Payload {
    std::optional<std::uint64_t> timestamp{};  ///< ms since 1970
    std::vector<Metric> metrics{};
    std::optional<std::uint64_t> seq{};
    friend bool operator==(const Payload&, const Payload&) = default;
};

inline constexpr std::size_t kMaxPayloadBytes = std::size_t{256} << 10;  ///< that is read
inline constexpr std::size_t kMaxMetrics = 4096;                         ///< likewise

/// As protobuf. Whole numbers of properties are Int32, those of metrics Int64 unless their type is narrower.
std::string write(const Payload& payload);

/// Any bytes; unknown fields and properties are passed over. Fails with a sentence.
Expected<Payload> read(std::string_view bytes);

}  // namespace asip::gateway::exports::sparkplug
