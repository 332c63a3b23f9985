// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/sparkplug_payload.hpp"

#include <gmock/gmock.h>

namespace asip::gateway::exports::sparkplug {
namespace {

using namespace std::string_literals;
using testing::HasSubstr;

/// Each type, and properties.
Payload everything() {
    Payload payload;
    payload.timestamp = 1'700'000'000'123;
    payload.seq = 255;
    const auto add = [&](const char* name, DataType type, Value value) {
        Metric metric;
        metric.name = name;
        metric.alias = payload.metrics.size();
        metric.timestamp = 1;
        metric.type = type;
        metric.value = std::move(value);
        payload.metrics.push_back(std::move(metric));
    };
    add("a", DataType::kInt64, std::int64_t{-5});
    add("b", DataType::kInt32, std::int64_t{-5});
    add("c", DataType::kDouble, 0.1);
    add("d", DataType::kBoolean, true);
    add("e", DataType::kString, "23 \xc2\xb0"s);
    add("f", DataType::kString, std::string());
    add("g", DataType::kInt64, {});
    return payload;
}

TEST(SparkplugPayload, WhatIsWritten_IsRead) {
    const auto read_back = read(write(everything()));
    ASSERT_TRUE(read_back) << read_back.error();
    EXPECT_EQ(*read_back, everything());
}

TEST(SparkplugPayload, BytesAreThoseOfTheWireFormat) {
    Payload payload;
    payload.timestamp = 300;
    payload.seq = 0;
    Metric metric;
    metric.name = "t";
    metric.alias = 1;
    metric.type = DataType::kDouble;
    metric.value = 1.0;
    metric.properties = {{"q", std::int64_t{192}}, {"u", "C"s}};
    payload.metrics.push_back(metric);
    EXPECT_EQ(write(payload),
              "\x08\xac\x02"                  // timestamp
              "\x12\x26"                      // metric
              "\x0a\x01t\x10\x01\x20\x0a"     // name, alias, Double
              "\x4a\x14\x0a\x01q\x0a\x01u"    // keys
              "\x12\x05\x08\x03\x18\xc0\x01"  // Int32 192
              "\x12\x05\x08\x0c\x42\x01"
              "C"  // String
              "\x69\x00\x00\x00\x00\x00\x00\xf0\x3f"
              "\x18\x00"s);  // seq
}

TEST(SparkplugPayload, SignsOfNarrowNumbers_AreRead_HoweverTheyWereExtended) {
    const auto value_of = [](DataType type, std::uint64_t bits) {
        const auto field = [](unsigned number, std::uint64_t value) {
            std::string out(1, static_cast<char>(number << 3));
            for (; value >= 0x80; value >>= 7)
                out += static_cast<char>(value | 0x80);
            return out + static_cast<char>(value);
        };
        // The type stands behind the value.
        const auto metric = field(10, bits) + field(4, static_cast<std::uint64_t>(type));
        const auto payload = read("\x12"s + static_cast<char>(metric.size()) + metric);
        return payload ? payload->metrics.at(0).value : Value("damaged"s);
    };
    EXPECT_EQ(value_of(DataType::kInt8, 0xff), Value(std::int64_t{-1}));
    EXPECT_EQ(value_of(DataType::kInt8, 0xffffffff), Value(std::int64_t{-1}));
    EXPECT_EQ(value_of(DataType::kInt16, 0xfffe), Value(std::int64_t{-2}));
    EXPECT_EQ(value_of(DataType::kInt32, 0xfffffffd), Value(std::int64_t{-3}));
    EXPECT_EQ(value_of(DataType::kUInt8, 0xff), Value(std::int64_t{255}));
    EXPECT_EQ(value_of(DataType::kUInt32, 0xffffffff), Value(std::int64_t{4294967295}));
    EXPECT_EQ(value_of(DataType::kUnknown, 0xffffffff), Value(std::int64_t{-1}));
}

TEST(SparkplugPayload, SeveralValuesOfOneMetric_TheLastCounts) {
    const auto value = [](const std::string& fields) {
        const auto read_now = read("\x12"s + static_cast<char>(fields.size()) + fields);
        return read_now ? read_now->metrics.at(0).value : Value("refused"s);
    };
    EXPECT_EQ(value("\x50\x07\x70\x01"s), Value(true));
    EXPECT_EQ(value("\x70\x01\x50\x07"s), Value(std::int64_t{7}));
    EXPECT_EQ(value("\x50\x07\x82\x01\x00"s), Value()) << "a data set is not read";
    EXPECT_EQ(value("\x50\x07\x80\x01\x08"s), Value("refused"s)) << "bytes are no number";
}

TEST(SparkplugPayload, FieldsThatAreUnknown_ArePassedOver) {
    // Metadata, a data set, a field of the future and a body.
    const auto payload = read("\x12\x10\x0a\x01t\x42\x02\x08\x01\x8a\x01\x01x\x70\x01\xfa\x3e\x00\x2a\x01z"s);
    ASSERT_TRUE(payload) << payload.error();
    ASSERT_EQ(payload->metrics.size(), 1u);
    EXPECT_EQ(payload->metrics[0].name, "t");
    EXPECT_EQ(payload->metrics[0].value, Value(true));
}

TEST(SparkplugPayload, CutOffAnywhere_IsRefusedOrShorter) {
    const auto whole = write(everything());
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const auto payload = read(std::string_view(whole).substr(0, size));
        if (payload) {
            EXPECT_LE(payload->metrics.size(), everything().metrics.size());
        }
    }
    EXPECT_FALSE(read(std::string_view(whole).substr(0, whole.size() - 1)));
}

TEST(SparkplugPayload, WhatIsNone_IsRefused_WithASentence) {
    EXPECT_THAT(read("90").error(), HasSubstr("no protobuf"));
    EXPECT_FALSE(read("{\"value\":1}"));
    EXPECT_FALSE(read("\x12\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"s));      // longer than there is
    EXPECT_FALSE(read("\x08\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"s));  // a number without an end
    EXPECT_FALSE(read("\x0b\x0c"s));                                          // a group
    EXPECT_FALSE(read("\x00\x01"s));                                          // field 0
    EXPECT_FALSE(read("\x0a\x01x"s));                                         // a time that is text
    EXPECT_FALSE(read("\x12\x02\x08\x01"s));                                  // a name that is a number
    EXPECT_THAT(read(std::string(kMaxPayloadBytes + 1, '\0')).error(), HasSubstr("262145 bytes"));
    std::string many;
    for (std::size_t i = 0; i <= kMaxMetrics; ++i)
        many += "\x12\x00"s;
    EXPECT_THAT(read(many).error(), HasSubstr("too many metrics"));
    EXPECT_TRUE(read(""));
}

}  // namespace
}  // namespace asip::gateway::exports::sparkplug
