// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/sparkplug_payload.hpp"

#include <bit>

namespace asip::gateway::exports::sparkplug {
namespace {

constexpr unsigned kPayloadBits = 7;  // of a byte of a varint
constexpr unsigned char kMore = 0x80;
constexpr unsigned kTypeBits = 3;  // of a tag
constexpr std::uint32_t kLargestField = (1u << 29) - 1;

enum WireType : std::uint32_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };

// Numbers of fields.
namespace payload_field {
constexpr std::uint32_t kTimestamp = 1, kMetrics = 2, kSeq = 3;
}
namespace metric_field {
constexpr std::uint32_t kName = 1, kAlias = 2, kTimestamp = 3, kType = 4, kIsNull = 7, kProperties = 9,
                        kInt = 10, kLong = 11, kFloat = 12, kDouble = 13, kBoolean = 14, kString = 15,
                        kExtension = 18;
}
namespace set_field {
constexpr std::uint32_t kKeys = 1, kValues = 2;
}
namespace property_field {
constexpr std::uint32_t kType = 1, kInt = 3, kDouble = 6, kBoolean = 7, kString = 8;
}

class Writer {
  public:
    void number(std::uint32_t field, std::uint64_t value) {
        varint(field << kTypeBits | kVarint);
        varint(value);
    }
    void text(std::uint32_t field, std::string_view value) {
        varint(field << kTypeBits | kBytes);
        varint(value.size());
        out_.append(value);
    }
    void real(std::uint32_t field, double value) {
        varint(field << kTypeBits | kFixed64);
        const auto bits = std::bit_cast<std::uint64_t>(value);
        for (unsigned shift = 0; shift < 64; shift += 8)
            out_ += static_cast<char>(bits >> shift & 0xff);
    }
    std::string take() { return std::move(out_); }

  private:
    void varint(std::uint64_t value) {
        for (; value >= kMore; value >>= kPayloadBits)
            out_ += static_cast<char>(value | kMore);
        out_ += static_cast<char>(value);
    }

    std::string out_;
};

std::uint64_t number_of(DataType type) {
    return static_cast<std::uint64_t>(type);
}

std::string property(const Value& value) {
    using namespace property_field;
    Writer out;
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
        out.number(kType, number_of(DataType::kInt32));
        out.number(kInt, static_cast<std::uint32_t>(*whole));
    } else if (const auto* real = std::get_if<double>(&value)) {
        out.number(kType, number_of(DataType::kDouble));
        out.real(kDouble, *real);
    } else if (const auto* yes = std::get_if<bool>(&value)) {
        out.number(kType, number_of(DataType::kBoolean));
        out.number(kBoolean, *yes ? 1 : 0);
    } else if (const auto* text = std::get_if<std::string>(&value)) {
        out.number(kType, number_of(DataType::kString));
        out.text(kString, *text);
    }
    return out.take();
}

std::string properties(const std::vector<Property>& all) {
    Writer out;
    for (const auto& each : all)
        out.text(set_field::kKeys, each.key);
    for (const auto& each : all)
        out.text(set_field::kValues, property(each.value));
    return out.take();
}

bool is_narrow(DataType type) {
    return (type >= DataType::kInt8 && type <= DataType::kInt32) ||
           (type >= DataType::kUInt8 && type <= DataType::kUInt32);
}

void value(Writer& out, const Metric& metric) {
    using namespace metric_field;
    if (const auto* whole = std::get_if<std::int64_t>(&metric.value))
        if (is_narrow(metric.type))
            out.number(kInt, static_cast<std::uint32_t>(*whole));
        else
            out.number(kLong, static_cast<std::uint64_t>(*whole));
    else if (const auto* real = std::get_if<double>(&metric.value))
        out.real(kDouble, *real);
    else if (const auto* yes = std::get_if<bool>(&metric.value))
        out.number(kBoolean, *yes ? 1 : 0);
    else if (const auto* text = std::get_if<std::string>(&metric.value))
        out.text(kString, *text);
}

std::string metric(const Metric& metric) {
    using namespace metric_field;
    Writer out;
    if (!metric.name.empty()) out.text(kName, metric.name);
    if (metric.alias) out.number(kAlias, *metric.alias);
    if (metric.timestamp) out.number(kTimestamp, *metric.timestamp);
    if (metric.type != DataType::kUnknown) out.number(kType, number_of(metric.type));
    if (std::holds_alternative<std::monostate>(metric.value)) out.number(kIsNull, 1);
    if (!metric.properties.empty()) out.text(kProperties, properties(metric.properties));
    value(out, metric);
    return out.take();
}

struct Field {
    std::uint32_t number = 0;
    std::uint32_t wire_type = kVarint;
    std::uint64_t value = 0;  // of a number, as its bits
    std::string_view bytes{};
};

/// Takes one message apart, field by field.
class Reader {
  public:
    explicit Reader(std::string_view bytes) : rest_(bytes) {}

    bool done() const { return rest_.empty(); }
    /// Nothing: the bytes end too early, or are no protobuf.
    std::optional<Field> next() {
        const auto tag = varint();
        if (!tag || *tag >> kTypeBits == 0 || *tag >> kTypeBits > kLargestField) return std::nullopt;
        Field field;
        field.number = static_cast<std::uint32_t>(*tag >> kTypeBits);
        field.wire_type = static_cast<std::uint32_t>(*tag & ((1u << kTypeBits) - 1));
        std::optional<std::uint64_t> value;
        switch (field.wire_type) {
            case kVarint:
                value = varint();
                break;
            case kFixed64:
                value = fixed(8);
                break;
            case kFixed32:
                value = fixed(4);
                break;
            case kBytes:
                value = varint();
                if (!value || *value > rest_.size()) return std::nullopt;
                field.bytes = rest_.substr(0, *value);
                rest_.remove_prefix(*value);
                break;
            default:
                return std::nullopt;  // groups: no program writes them any more
        }
        if (!value) return std::nullopt;
        field.value = *value;
        return field;
    }

  private:
    std::optional<std::uint64_t> varint() {
        std::uint64_t value = 0;
        for (unsigned shift = 0; shift < 64; shift += kPayloadBits) {
            if (rest_.empty()) return std::nullopt;
            const auto byte = static_cast<unsigned char>(rest_.front());
            rest_.remove_prefix(1);
            value |= static_cast<std::uint64_t>(byte & (kMore - 1)) << shift;
            if ((byte & kMore) == 0) return value;
        }
        return std::nullopt;
    }
    std::optional<std::uint64_t> fixed(unsigned bytes) {
        if (rest_.size() < bytes) return std::nullopt;
        std::uint64_t value = 0;
        for (unsigned i = 0; i < bytes; ++i)
            value |= static_cast<std::uint64_t>(static_cast<unsigned char>(rest_[i])) << (8 * i);
        rest_.remove_prefix(bytes);
        return value;
    }

    std::string_view rest_;
};

/// What stands in int_value: of a type that is narrower writers differ in how they extend the sign.
std::int64_t whole_of(DataType type, std::uint64_t bits) {
    switch (type) {
        case DataType::kInt8:
            return static_cast<std::int8_t>(bits);
        case DataType::kInt16:
            return static_cast<std::int16_t>(bits);
        case DataType::kUInt8:
        case DataType::kUInt16:
        case DataType::kUInt32:
            return static_cast<std::uint32_t>(bits);
        default:
            return static_cast<std::int32_t>(bits);
    }
}

Value long_of(DataType type, std::uint64_t bits) {
    const auto whole = static_cast<std::int64_t>(bits);
    if (type == DataType::kUInt64 && whole < 0) return static_cast<double>(bits);
    return whole;
}

/// A member of the oneof of values.
Value value_of(DataType type, const Field& field) {
    using namespace metric_field;
    switch (field.number) {
        case kInt:
            return whole_of(type, field.value);
        case kLong:
            return long_of(type, field.value);
        case kFloat:
            return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(field.value)));
        case kDouble:
            return std::bit_cast<double>(field.value);
        case kBoolean:
            return field.value != 0;
        case kString:
            return std::string(field.bytes);
        default:
            return {};  // a data set, a template or an extension
    }
}

std::uint32_t wire_type_of(std::uint32_t number) {
    using namespace metric_field;
    switch (number) {
        case kName:
        case kString:
            return kBytes;
        case kFloat:
            return kFixed32;
        case kDouble:
            return kFixed64;
        default:
            return number > kString ? kBytes : kVarint;  // a data set, a template or an extension
    }
}

std::optional<Metric> metric_from(std::string_view bytes) {
    using namespace metric_field;
    Reader reader(bytes);
    Metric metric;
    std::optional<Field> value;  // the last one counts; the type, which says its sign, may stand behind it
    bool is_null = false;
    while (!reader.done()) {
        const auto field = reader.next();
        if (!field) return std::nullopt;
        const auto number = field->number;
        const bool is_known = (number >= kName && number <= kType) || number == kIsNull ||
                              (number >= kInt && number <= kExtension);
        if (is_known && field->wire_type != wire_type_of(number)) return std::nullopt;
        if (number == kName) metric.name = field->bytes;
        if (number == kAlias) metric.alias = field->value;
        if (number == kTimestamp) metric.timestamp = field->value;
        if (number == kType) metric.type = static_cast<DataType>(static_cast<std::uint32_t>(field->value));
        if (number == kIsNull) is_null = field->value != 0;
        if (number >= kInt && number <= kExtension) value = field;
    }
    if (value && !is_null) metric.value = value_of(metric.type, *value);
    return metric;
}

}  // namespace

std::string write(const Payload& payload) {
    using namespace payload_field;
    Writer out;
    if (payload.timestamp) out.number(kTimestamp, *payload.timestamp);
    for (const auto& each : payload.metrics)
        out.text(kMetrics, metric(each));
    if (payload.seq) out.number(kSeq, *payload.seq);
    return out.take();
}

Expected<Payload> read(std::string_view bytes) {
    using namespace payload_field;
    if (bytes.size() > kMaxPayloadBytes)
        return fail("it has " + std::to_string(bytes.size()) + " bytes, and " +
                    std::to_string(kMaxPayloadBytes) + " are taken");
    Reader reader(bytes);
    Payload payload;
    while (!reader.done()) {
        const auto field = reader.next();
        if (!field) return fail("it is no protobuf, or is cut off");
        if (field->number == kMetrics && field->wire_type == kBytes) {
            if (payload.metrics.size() == kMaxMetrics) return fail("it has too many metrics");
            auto metric = metric_from(field->bytes);
            if (!metric) return fail("metric " + std::to_string(payload.metrics.size() + 1) + " is damaged");
            payload.metrics.push_back(std::move(*metric));
        } else if (field->number == kTimestamp && field->wire_type == kVarint) {
            payload.timestamp = field->value;
        } else if (field->number == kSeq && field->wire_type == kVarint) {
            payload.seq = field->value;
        } else if (field->number <= kSeq) {
            return fail("it is no payload of Sparkplug B");
        }
    }
    return payload;
}

}  // namespace asip::gateway::exports::sparkplug
