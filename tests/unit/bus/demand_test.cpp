// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/demand.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace asip::bus {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(Demand, Text_IsReadBack) {
    const Demand demand{{{"distance", 20}, {"io", .5}, {"*", 1}}, std::chrono::seconds(7)};
    EXPECT_EQ(parse_demand(to_text(demand)).value(), demand);
    EXPECT_EQ(to_text({{{"distance", 20}}, kDemandLease}), R"({"lease":15,"services":{"distance":20.0}})");
}

TEST(Demand, WithoutLease_HasTheUsualOne_AndZeroIsNoDemand) {
    const auto demand = parse_demand(R"({"services":{"distance":0,"io":3},"later":[1]})").value();
    EXPECT_EQ(demand.lease, kDemandLease);
    EXPECT_EQ(demand.services, (std::map<std::string, double>{{"io", 3}}));
    EXPECT_THAT(parse_demand(R"({"services":{}})").value().services, IsEmpty());
}

TEST(Demand, AbsurdRate_IsOne) {
    EXPECT_EQ(parse_demand(R"({"services":{"io":1e308}})").value().services.at("io"), 1e308);
    EXPECT_GT(parse_demand(R"({"services":{"io":1e-308}})").value().services.at("io"), 0);
}

TEST(Demand, Garbage_IsRefusedWithItsPlace) {
    std::string many;
    for (int i = 0; i < 33; ++i)
        many += (i ? ",\"s" : "\"s") + std::to_string(i) + "\":1";
    const std::vector<std::pair<std::string, std::string>> rows{
        {"", ""},
        {"20", "object"},
        {"{}", "/services: is missing"},
        {R"({"services":[1]})", "/services"},
        {R"({"services":{"io":-1}})", "/services/io: must be a number"},
        {R"({"services":{"io":"20"}})", "/services/io: must be a number"},
        {R"({"services":{"io":null}})", "/services/io: must be a number"},
        {R"({"services":{"io":true}})", "/services/io: must be a number"},
        {R"({"services":{"io":NaN}})", ""},
        {R"({"services":{"io":1e999}})", ""},
        {R"({"services":{"":1}})", "a name that no service can have"},
        {R"({"services":{"a b":1}})", "a name that no service can have"},
        {R"({"services":{"a/b":1}})", "a name that no service can have"},
        {R"({"services":{")" + std::string(65, '*') + R"(":1}})", "a name that no service can have"},
        {R"({"services":{)" + many + "}}", "more than 32 members"},
        {R"({"services":{"io":1},"lease":0})", "/lease"},
        {R"({"services":{"io":1},"lease":301})", "/lease"},
        {R"({"services":{"io":1},"lease":-3})", "/lease"},
        {R"({"services":{"io":1},"lease":1.5})", "/lease"},
        {R"({"services":{"io":[[[[1]]]]}})", ""},
        {R"({"services":{"io":1},"x":")" + std::string(kMaxDemandBytes, 'x') + R"("})", ""},
    };
    for (const auto& [text, why] : rows) {
        const auto demand = parse_demand(text);
        ASSERT_FALSE(demand) << text.substr(0, 80);
        EXPECT_THAT(demand.error(), HasSubstr(why)) << text.substr(0, 80);
    }
}

}  // namespace
}  // namespace asip::bus
