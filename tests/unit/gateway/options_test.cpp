// SPDX-License-Identifier: Apache-2.0
#include "gateway/options.hpp"

#include <gmock/gmock.h>

namespace asip::gateway {
namespace {

using testing::HasSubstr;

ProgramOptions listening_on(const std::string& address, const std::string& tokens = {}) {
    ProgramOptions options;
    options.addresses = {address};
    options.tokens = tokens;
    return options;
}

TEST(GatewayAccess, ReachableByOthersAndNothingChosen_IsRefusedWithTheChoices) {
    for (const char* address : {"0.0.0.0:8080", "[::]:8080", "192.168.1.7:8080"}) {
        auto options = listening_on(address);
        const auto access = check_access(options, "none", "", false);
        ASSERT_FALSE(access) << address;
        EXPECT_THAT(access.error(), HasSubstr("--tokens"));
        EXPECT_THAT(access.error(), HasSubstr("--anonymous"));
    }
    auto one_of_two = listening_on("127.0.0.1:8080");
    one_of_two.addresses.push_back("0.0.0.0:8081");
    EXPECT_FALSE(check_access(one_of_two, "none", "", false));
}

TEST(GatewayAccess, BehindAProxy_TheServerCountsItsClientsNotTheProxy) {
    auto options = listening_on("127.0.0.1:8080");
    ASSERT_TRUE(check_access(options, "none", "", true));
    EXPECT_TRUE(options.gateway.gate.behind_proxy);
    EXPECT_TRUE(options.limits.behind_proxy);
}

TEST(GatewayAccess, ReachableByOthersWithTokens_NothingWithoutOne) {
    auto options = listening_on("0.0.0.0:8080", "tokens");
    ASSERT_TRUE(check_access(options, "none", "", false));
    EXPECT_EQ(options.gateway.gate.loopback.role, Role::kNone);
    EXPECT_EQ(options.gateway.gate.anonymous.role, Role::kNone);
}

TEST(GatewayAccess, Anonymous_OnlyWhatWasChosen) {
    auto options = listening_on("0.0.0.0:8080");
    ASSERT_TRUE(check_access(options, "viewer", "", false));
    EXPECT_EQ(options.gateway.gate.anonymous.role, Role::kViewer);
}

TEST(GatewayAccess, Class_OthersMayJoinALesson_AndThisMachineHoldsIt) {
    auto options = listening_on("0.0.0.0:8080");
    ASSERT_TRUE(check_access(options, "class", "", false));
    EXPECT_EQ(options.gateway.gate.anonymous.role, Role::kNone);
    EXPECT_EQ(options.gateway.gate.loopback.role, Role::kAdmin);
}

TEST(GatewayAccess, LoopbackUnconfigured_IsAdmin) {
    auto options = listening_on("127.0.0.1:8080");
    ASSERT_TRUE(check_access(options, "none", "", false));
    EXPECT_EQ(options.gateway.gate.loopback.role, Role::kAdmin);
    EXPECT_TRUE(options.gateway.gate.loopback.may_send_raw());
}

TEST(GatewayAccess, BehindAProxy_LoopbackMayNothing) {
    auto options = listening_on("127.0.0.1:8080");
    ASSERT_TRUE(check_access(options, "none", "", true));
    EXPECT_EQ(options.gateway.gate.loopback.role, Role::kNone);
    EXPECT_FALSE(check_access(options, "none", "admin", true)) << "not even when asked for";
}

}  // namespace
}  // namespace asip::gateway
