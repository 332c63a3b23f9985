// SPDX-License-Identifier: Apache-2.0
// Reports that do not fit the model of their service.
#include <gmock/gmock.h>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Undecoded : OnlineBridge {
    std::uint64_t counted() {
        bench.published.clear();
        bench.publish_statistics();
        return nlohmann::json::parse(bench.on("asip/servicebus/uno1/$stats").back())["line"]["undecoded"];
    }
    std::vector<std::string> warnings() {
        bench.pass(2s);
        const auto descriptions = bench.on("asip/servicebus/uno1/$description");
        return descriptions.empty() ? std::vector<std::string>()
                                    : model::parse_description(descriptions.back()).value().warnings;
    }
};

TEST_F(Undecoded, ElementThatIsNoNumber_CostsNoOtherOne) {
    bench.say("@D,e,3,{1,nan,3}\n@D,e,2,{,1e-05}\n");
    EXPECT_THAT(bench.on("asip/uno1/distance/out"),
                ElementsAre(R"({"distance":[1,null,3]})", R"({"distance":[null,1e-05]})"));
    EXPECT_EQ(counted(), 0u);
}

TEST_F(Undecoded, ReportThatDoesNotFit_IsCountedAndLoggedOnceAService) {
    bench.notices.clear();
    for (int i = 0; i < 5; ++i)
        bench.say("@D,e,1,{abc}\n@S,x,1\n");
    EXPECT_THAT(bench.on("asip/uno1/distance/out"), IsEmpty());
    EXPECT_THAT(bench.on("asip/uno1/out"), Contains("@D,e,1,{abc}"));
    EXPECT_EQ(bench.notices.size(), 2u) << testing::PrintToString(bench.notices);
    EXPECT_EQ(counted(), 10u);
    EXPECT_THAT(warnings(), IsEmpty());
}

// AsipMotors.h: each step is reported once, by M or by E.
TEST_F(Undecoded, EncodersReportedByTheMotors_AreThoseOfTheEncoders) {
    bench.board.services = "IME";
    bench.board.replies["#,N"] = "@#,N,3,{I:ASIP core IO,M:Motors,E:Encoders}";
    bench.say(bench.board.banner());
    bench.pass(5s);
    bench.published.clear();
    for (int i = 0; i < 10; ++i)
        bench.say("@M,e,2,{3000:11,3100:-2}\n");
    EXPECT_THAT(bench.on("asip/uno1/out"), Contains("@M,e,2,{3000:11,3100:-2}"));
    const auto values = bench.on("asip/uno1/encoders/out");
    ASSERT_EQ(values.size(), 10u);
    EXPECT_EQ(values[0], R"({"encoders":[{"count":11,"pulse":3000},{"count":-2,"pulse":3100}]})");
    EXPECT_EQ(counted(), 0u);
    EXPECT_THAT(warnings(), testing::Not(Contains(HasSubstr("do not fit"))));
    bench.say("@M,x,1,{1}\n");
    EXPECT_EQ(counted(), 1u) << "what neither has";
}

TEST_F(Undecoded, Often_IsAWarning) {
    for (int i = 0; i < 10; ++i)
        bench.say("@D,e,1,{abc}\n");
    EXPECT_THAT(warnings(), ElementsAre(HasSubstr("reports of distance do not fit")));
    bench.say("@D,e,1,{7}\n");
    EXPECT_THAT(bench.on("asip/uno1/distance/out"), ElementsAre(R"({"distance":[7]})"));
}

}  // namespace
}  // namespace asip::agent
