// SPDX-License-Identifier: Apache-2.0
#include "asip/model/event_decoder.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/model_set.hpp"

namespace asip::model {
namespace {

Expected<nlohmann::json> decode(const char* model, std::string_view line, const DecodeContext& context = {}) {
    return decode_event(*ModelSet::standard().find(model),
                        std::get<protocol::Event>(protocol::parse_line(line)), context);
}

TEST(DecodeEvent, DigitalWithModes_NamesInputPinsOnly) {
    const auto ports = protocol::PortMap::parse("3,{4:1,4:2,4:4}").value();
    const std::vector<protocol::PinMode> modes = {protocol::PinMode::kInput, protocol::PinMode::kOutput,
                                                  protocol::PinMode::kInputPullup};
    EXPECT_EQ(dump_json(decode("io", "@I,d,4,5", {&ports, modes}).value()), R"({"digital":{"0":1,"2":1}})");
}

TEST(DecodeEvent, DigitalWithoutPortMap_IsRefused) {
    const protocol::PortMap empty;
    EXPECT_FALSE(decode("io", "@I,d,4,5"));
    EXPECT_FALSE(decode("io", "@I,d,4,5", {&empty, {}}));
}

TEST(DecodeEvent, SparseIndexes_LeaveNullBetween) {
    EXPECT_EQ(dump_json(decode("distance", "@D,e,1,{2:7}").value()), R"({"distance":[null,null,7]})");
}

TEST(DecodeEvent, IndexBeforeSeveralFields_IsUnderstood) {
    EXPECT_EQ(dump_json(decode("encoders", "@E,e,1,{0:3000:11}").value()),
              R"({"encoders":[{"count":11,"pulse":3000}]})");
}

TEST(DecodeEvent, NoElements_IsAnEmptyArray) {
    EXPECT_EQ(dump_json(decode("distance", "@D,e,0,{}").value()), R"({"distance":[]})");
}

TEST(DecodeEvent, SensorWithFewerAxes_LeavesTheRestOut) {
    EXPECT_EQ(dump_json(decode("heading", "@H,e,3,{1,2,3}").value()), R"({"heading":{"x":1,"y":2,"z":3}})");
}

TEST(DecodeEvent, DamagedBody_IsRefused) {
    for (const std::string_view line :
         {"@D,e,2,{42}", "@D,e,3,{42,}", "@D,e,1,{x}", "@D,e,2,{}", "@D,e,1,{1:2:3}", "@D,e,1,{999:2}",
          "@D,e,1,{-1:2}", "@D,e,1,{1e}", "@D,e,1,{e5}", "@D,e,1,{nanx}", "@D,e,1,{0x1p3}", "@D,e,1,{1 }",
          "@D,e"}) {
        EXPECT_FALSE(decode("distance", line)) << line;
    }
    EXPECT_FALSE(decode("encoders", "@E,e,1,{5}"));
    EXPECT_FALSE(decode("acceleration", "@A,e,4,{1,2,3,4}"));
    EXPECT_FALSE(decode("acceleration", "@A,e,0,{}"));
    EXPECT_FALSE(decode("pixels", "@P,I,1,2"));
    EXPECT_FALSE(decode("pixels", "@P,I"));
    EXPECT_FALSE(decode("io", "@I,a,1,{1:2:3}"));
    EXPECT_FALSE(decode("io", "@I,a,1,{x:2}"));
    EXPECT_FALSE(decode("io", "@I,M,1,{4}"));
}

TEST(DecodeEvent, ElementWithoutAValue_IsNullAndTheOthersPass) {
    for (const char* none : {"nan", "NaN", "-nan", "inf", "-inf", "+Inf", "infinity", "ovf", "", "1e400",
                             "-1e400", "1e15", "99999999999999999999999"}) {
        EXPECT_EQ(dump_json(decode("distance", "@D,e,3,{1," + std::string(none) + ",3}").value()),
                  R"({"distance":[1,null,3]})")
            << none;
        EXPECT_EQ(dump_json(decode("heading", "@H,e,3,{1," + std::string(none) + ",3}").value()),
                  R"({"heading":{"x":1,"y":null,"z":3}})")
            << none;
        EXPECT_EQ(dump_json(decode("encoders", "@E,e,1,{" + std::string(none) + ":11}").value()),
                  R"({"encoders":[{"count":11,"pulse":null}]})")
            << none;
    }
    EXPECT_EQ(dump_json(decode("distance", "@D,e,2,{,42}").value()), R"({"distance":[null,42]})");
    EXPECT_EQ(dump_json(decode("distance", "@D,e,2,{42,}").value()), R"({"distance":[42,null]})");
    EXPECT_EQ(dump_json(decode("distance", "@D,e,1,{}").value()), R"({"distance":[null]})");
    EXPECT_EQ(dump_json(decode("encoders", "@E,e,2,{,1:2}").value()),
              R"({"encoders":[{"count":null,"pulse":null},{"count":2,"pulse":1}]})");
}

TEST(DecodeEvent, NumbersInEachNotation_AreNumbers) {
    EXPECT_EQ(dump_json(decode("distance", "@D,e,7,{1e-05,1E3,-2.5e1,+1.5,-0,-0.0,5e-324}").value()),
              R"({"distance":[1e-05,1000.0,-25.0,1.5,0,0.0,5e-324]})");
}

TEST(DecodeEvent, UnknownTag_IsRefused) {
    EXPECT_EQ(decode("distance", "@D,z,1,{1}").error(), "distance has no event 'z'");
}

}  // namespace
}  // namespace asip::model
