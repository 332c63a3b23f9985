// SPDX-License-Identifier: Apache-2.0
#include "bench/load/options.hpp"

#include <gmock/gmock.h>

namespace asip::load {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

Expected<LoadOptions, int> read(std::vector<const char*> words) {
    words.insert(words.begin(), "asip-load");
    return read_options(static_cast<int>(words.size()), words.data());
}

std::string fault_of(std::vector<const char*> words) {
    testing::internal::CaptureStderr();
    const auto options = read(std::move(words));
    const auto said = testing::internal::GetCapturedStderr();
    EXPECT_FALSE(options);
    EXPECT_EQ(options ? 0 : options.error(), 2);
    return said;
}

TEST(LoadOptions, Nothing_IsAHundredBoardsThatJoinAtTheRate) {
    const auto options = read({});
    ASSERT_TRUE(options);
    EXPECT_EQ(options->fleet.boards, 100u);
    EXPECT_EQ(options->fleet.per_connection, 1u);
    ASSERT_EQ(options->steps.size(), 1u);
    EXPECT_EQ(options->steps[0].verb, Verb::kJoin);
    EXPECT_EQ(options->steps[0].over, 200ms);
    EXPECT_EQ(options->time, std::nullopt);
}

TEST(LoadOptions, WhatRegistriesBear_IsAskedForByOptions) {
    const auto none = read({});
    EXPECT_EQ(none->queries_per_second, 0);
    EXPECT_EQ(none->watchers, 0u);
    const auto options = read({"--queries", "0.5", "--watchers", "20"});
    ASSERT_TRUE(options);
    EXPECT_EQ(options->queries_per_second, 0.5);
    EXPECT_EQ(options->watchers, 20u);
}

TEST(LoadOptions, Steps_ComeAfterTheJoinUnlessOneJoinsAtTheStart) {
    EXPECT_EQ(read({"--step", "5s die 5", "--step", "9s join 5"})->steps.size(), 3u);
    EXPECT_EQ(read({"--step", "0s join 5"})->steps.size(), 1u);
}

TEST(LoadOptions, Wrong_IsRefusedInWords) {
    EXPECT_THAT(fault_of({"--step", "5s dye 5"}), HasSubstr("--step: \"dye\""));
    EXPECT_THAT(fault_of({"--script", "/no/such"}), HasSubstr("--script: cannot read /no/such"));
    EXPECT_THAT(fault_of({"--time", "10s", "--step", "9s die 5 over 2s"}),
                HasSubstr("is over before die is"));
    EXPECT_THAT(fault_of({"--time", "soon"}), HasSubstr("--time: "));
    EXPECT_THAT(fault_of({"--prefix", "a b"}), HasSubstr("--prefix: "));
    EXPECT_THAT(fault_of({"--models", "distnace"}), HasSubstr("did you mean \"distance\""));
    EXPECT_THAT(fault_of({"--boards", "0"}), HasSubstr("--boards"));
    EXPECT_THAT(fault_of({"--bords", "5"}), HasSubstr("--boards"));
    EXPECT_THAT(fault_of({"--queries", "-1"}), HasSubstr("--queries"));
    EXPECT_THAT(fault_of({"--queries", "100001"}), HasSubstr("--queries"));
    EXPECT_THAT(fault_of({"--watchers", "10001"}), HasSubstr("--watchers"));
    EXPECT_THAT(fault_of({"--watchers", "few"}), HasSubstr("--watchers"));
    EXPECT_THAT(fault_of({"--broker", "http://x"}), HasSubstr("http://x"));
}

TEST(LoadOptions, MoreBoardsThanOneConnectionEachAllows_ShareThem) {
    EXPECT_EQ(boards_per_connection(200, 1024, 28000), 1u);
    EXPECT_EQ(boards_per_connection(241, 1024, 28000), 2u);
    EXPECT_EQ(boards_per_connection(50'000, 1'000'000, 28'000), 2u) << "ports, not files";
    EXPECT_EQ(boards_per_connection(10, 16, 28'000), 10u);
    EXPECT_THAT(fault_of({"--boards", "1000000", "--boards-per-connection", "1"}),
                HasSubstr("need at least"));
}

}  // namespace
}  // namespace asip::load
