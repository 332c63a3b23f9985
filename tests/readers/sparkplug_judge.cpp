// SPDX-License-Identifier: Apache-2.0
#include "tests/readers/sparkplug_judge.hpp"

#include <array>
#include <cstring>
#include <vector>

namespace readers {

namespace {

using namespace asip::gateway::exports::sparkplug;

enum Wire : unsigned { kVarint = 0, kEight = 1, kLength = 2, kGroup = 3, kGroupEnd = 4, kFour = 5 };

struct Field {
    std::uint64_t number;
    unsigned wire;
    std::uint64_t value;
    std::string_view bytes;
};

/// What bytes mean.
struct Message {
    enum Kind : std::uint8_t { kDamaged, kReadable, kOdd } is = kDamaged;  ///< kOdd: readers may refuse it
    std::vector<Field> fields{};
};

/// Seven bits a byte, the lowest first; at most ten bytes.
bool take_varint(std::string_view& bytes, std::uint64_t& value, std::size_t& size) {
    constexpr std::size_t kMaxBytes = 10;
    value = 0;
    for (size = 0; size < kMaxBytes && size < bytes.size(); ++size) {
        const auto byte = static_cast<unsigned char>(bytes[size]);
        value += (byte & std::uint64_t{127}) << (7 * size);
        if (byte > 127) continue;
        bytes.remove_prefix(++size);
        return true;
    }
    return false;
}

std::uint64_t little_endian(std::string_view bytes) {
    std::uint64_t value = 0;
    for (auto at = bytes.size(); at-- > 0;)
        value = value * 256 + static_cast<unsigned char>(bytes[at]);
    return value;
}

Message fields_of(std::string_view bytes) {
    constexpr std::size_t kTagBytes = 5;
    constexpr std::uint64_t kMaxNumber = (1u << 29) - 1;
    Message message{Message::kReadable, {}};
    while (!bytes.empty()) {
        std::uint64_t tag = 0, length = 0;
        std::size_t size = 0;
        if (!take_varint(bytes, tag, size)) return {};
        if (size > kTagBytes) message.is = Message::kOdd;
        Field field{tag / 8, static_cast<unsigned>(tag % 8), 0, {}};
        if (field.number == 0 || field.number > kMaxNumber) return {};
        if (field.wire == kVarint) {
            if (!take_varint(bytes, field.value, size)) return {};
        } else if (field.wire == kLength) {
            if (!take_varint(bytes, length, size) || length > bytes.size()) return {};
        } else if (field.wire == kEight || field.wire == kFour) {
            length = field.wire == kEight ? 8 : 4;
            if (length > bytes.size()) return {};
            field.value = little_endian(bytes.substr(0, length));
        } else {
            // Groups have gone out of use, and the other two are none.
            return {field.wire == kGroup ? Message::kOdd : Message::kDamaged, {}};
        }
        field.bytes = bytes.substr(0, length);
        bytes.remove_prefix(length);
        message.fields.push_back(field);
    }
    return message;
}

bool same(const Value& a, const Value& b) {
    const auto* x = std::get_if<double>(&a);
    const auto* y = std::get_if<double>(&b);
    if (x == nullptr || y == nullptr) return a == b;
    return std::memcmp(x, y, sizeof *x) == 0 || (*x != *x && *y != *y);
}

using Values = std::vector<Value>;  // each of them is right

Values of_int(DataType type, std::uint32_t bits) {
    const std::int64_t plain = bits, with_sign = static_cast<std::int32_t>(bits);
    // Writers differ in how far they extend the sign.
    const auto narrow = [&](std::int64_t values) -> Values {
        if (with_sign >= -values / 2 && with_sign < values / 2) return {with_sign};
        return plain < values ? Values{plain - values} : Values{};
    };
    switch (type) {
        case DataType::kInt8:
            return narrow(256);
        case DataType::kInt16:
            return narrow(65536);
        case DataType::kInt32:
            return {with_sign};
        case DataType::kUInt8:
            return plain < 256 ? Values{plain} : Values{};
        case DataType::kUInt16:
            return plain < 65536 ? Values{plain} : Values{};
        case DataType::kUInt32:
            return {plain};
        default:
            return {plain, with_sign};
    }
}

Values of_long(DataType type, std::uint64_t bits) {
    const auto with_sign = static_cast<std::int64_t>(bits);
    if (with_sign >= 0 || type == DataType::kInt64) return {with_sign};
    if (type == DataType::kUInt64) return {static_cast<double>(bits)};
    return {with_sign, static_cast<double>(bits)};
}

double real_of(const Field& field) {
    if (field.wire == kFour) {
        const auto bits = static_cast<std::uint32_t>(field.value);
        float real = 0;
        std::memcpy(&real, &bits, sizeof real);
        return static_cast<double>(real);
    }
    double real = 0;
    std::memcpy(&real, &field.value, sizeof real);
    return real;
}

struct Wanted {
    Message::Kind is = Message::kReadable;
    Metric metric{};
    Values values{Value()};
};

/// A member of the oneof: the last one counts.
Values value_of(const Field& field, DataType type) {
    switch (field.number) {
        case 10:
            return of_int(type, static_cast<std::uint32_t>(field.value));
        case 11:
            return of_long(type, field.value);
        case 12:
        case 13:
            return {real_of(field)};
        case 14:
            return {field.value != 0};
        case 15:
            return {std::string(field.bytes)};
        default:
            return {Value()};  // a data set, a template, an extension
    }
}

Wanted metric_of(std::string_view bytes) {
    // name, alias, timestamp, datatype, is_historical, is_transient, is_null, metadata, properties, values
    constexpr std::array<unsigned, 19> kWires{9,       kLength, kVarint, kVarint, kVarint, kVarint, kVarint,
                                              kVarint, kLength, kLength, kVarint, kVarint, kFour,   kEight,
                                              kVarint, kLength, kLength, kLength, kLength};
    const auto message = fields_of(bytes);
    Wanted wanted{message.is, {}};
    const Field* value = nullptr;
    bool is_null = false;
    for (const auto& field : message.fields) {
        if (field.number >= kWires.size()) continue;
        if (field.wire != kWires[field.number]) {
            wanted.is = Message::kOdd;
            continue;
        }
        if (field.number == 1) wanted.metric.name = field.bytes;
        if (field.number == 2) wanted.metric.alias = field.value;
        if (field.number == 3) wanted.metric.timestamp = field.value;
        if (field.number == 4)
            wanted.metric.type = static_cast<DataType>(static_cast<std::uint32_t>(field.value));
        if (field.number == 7) is_null = field.value != 0;
        if (field.number >= 10) value = &field;
    }
    if (value != nullptr && !is_null) wanted.values = value_of(*value, wanted.metric.type);
    return wanted;
}

const char* compare(const Metric& read, const Wanted& wanted) {
    if (read.name != wanted.metric.name || read.alias != wanted.metric.alias) return "another metric";
    if (read.timestamp != wanted.metric.timestamp) return "another time of a metric";
    if (read.type != wanted.metric.type) return "another type";
    if (wanted.values.empty()) return nullptr;  // no value of this type
    for (const auto& value : wanted.values)
        if (same(read.value, value)) return nullptr;
    return "another value";
}

}  // namespace

const char* judge_sparkplug(std::string_view bytes, const std::optional<Payload>& read) {
    // timestamp, metrics, seq, uuid, body
    constexpr std::array<unsigned, 6> kWires{9, kVarint, kLength, kVarint, kLength, kLength};
    const auto message = fields_of(bytes);
    auto is = message.is;
    Payload wanted;
    std::vector<Wanted> metrics;
    for (const auto& field : message.fields) {
        if (field.number >= kWires.size()) continue;
        if (field.wire != kWires[field.number]) {
            if (is == Message::kReadable) is = Message::kOdd;
            continue;
        }
        if (field.number == 1) wanted.timestamp = field.value;
        if (field.number == 3) wanted.seq = field.value;
        if (field.number != 2) continue;
        metrics.push_back(metric_of(field.bytes));
        if (metrics.back().is == Message::kDamaged) is = Message::kDamaged;
        if (metrics.back().is == Message::kOdd && is == Message::kReadable) is = Message::kOdd;
    }
    if (!read) return is == Message::kReadable ? "it refused a good payload" : nullptr;
    if (is == Message::kDamaged) return "it read a damaged payload";
    if (read->timestamp != wanted.timestamp || read->seq != wanted.seq) return "another time or number";
    if (read->metrics.size() != metrics.size()) return "another number of metrics";
    for (std::size_t i = 0; i < metrics.size(); ++i)
        if (const char* wrong = compare(read->metrics[i], metrics[i])) return wrong;
    return nullptr;
}

}  // namespace readers
