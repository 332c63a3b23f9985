// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/topics.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace asip::bus {
namespace {

struct Row {
    std::string topic;
    TopicRef ref;
};

std::vector<Row> all_rows(const Topics& topics) {
    using enum TopicKind;
    return {
        {topics.board_names(), {kBoardNames, {}, {}}},
        {topics.service_names("uno1"), {kServiceNames, "uno1", {}}},
        {topics.state("uno1"), {kState, "uno1", {}}},
        {topics.description("uno1"), {kDescription, "uno1", {}}},
        {topics.stats("uno1"), {kStats, "uno1", {}}},
        {topics.log("uno1"), {kLog, "uno1", {}}},
        {topics.commands("uno1"), {kCommands, "uno1", {}}},
        {topics.demand("uno1", "ann/c1"), {kDemand, "uno1", {}, "ann/c1"}},
        {topics.stop("uno1"), {kStop, "uno1", {}}},
        {topics.probe(), {kProbe, {}, {}}},
        {topics.board_out("uno1"), {kBoardOut, "uno1", {}}},
        {topics.board_in("uno1"), {kBoardIn, "uno1", {}}},
        {topics.service_out("uno1", "distance"), {kServiceOut, "uno1", "distance"}},
        {topics.service_in("uno1", "distance"), {kServiceIn, "uno1", "distance"}},
        {topics.service_error("uno1", "distance"), {kServiceError, "uno1", "distance"}},
        {topics.service_set("uno1", "distance"), {kServiceSet, "uno1", "distance"}},
        {topics.registry_state("r1"), {kRegistryState, "r1", {}}},
        {topics.registry_stats("r1"), {kRegistryStats, "r1", {}}},
        {topics.registry_events("r1"), {kRegistryEvents, "r1", {}}},
        {topics.registry_query("r1"), {kRegistryQuery, "r1", {}}},
        {topics.any_registry_query(), {kAnyRegistryQuery, {}, {}}},
    };
}

TEST(Topics, EachBuilder_IsParsedBackUnderAnyRoot) {
    for (const char* root : {"asip", "a", "site/hall 3/asip"}) {
        const Topics topics{root};
        for (const auto& row : all_rows(topics)) {
            const auto parsed = topics.parse(row.topic);
            ASSERT_TRUE(parsed) << row.topic;
            EXPECT_EQ(*parsed, row.ref) << row.topic;
        }
    }
}

TEST(Topics, LiteralTopicsOfTheProtocol_AreWhatTheBuildersMake) {
    const Topics topics;
    EXPECT_EQ(topics.board_names(), "asip/servicebus");
    EXPECT_EQ(topics.state("uno1"), "asip/servicebus/uno1/$state");
    EXPECT_EQ(topics.stats("uno1"), "asip/servicebus/uno1/$stats");
    EXPECT_EQ(topics.stop("uno1"), "asip/uno1/$stop");
    EXPECT_EQ(topics.service_error("uno1", "io"), "asip/uno1/io/error");
    EXPECT_EQ(topics.any_registry_query(), "asip/registry/query");
    EXPECT_EQ(topics.registry_events("r1"), "asip/registry/r1/events");
}

TEST(Topics, ServiceNamedLikeADirection_IsStillAService) {
    const Topics topics;
    EXPECT_EQ(topics.parse("asip/uno1/in/out"), (TopicRef{TopicKind::kServiceOut, "uno1", "in"}));
    EXPECT_EQ(topics.parse("asip/uno1/set/out"), (TopicRef{TopicKind::kServiceOut, "uno1", "set"}));
    EXPECT_EQ(topics.parse("asip/uno1/set/set"), (TopicRef{TopicKind::kServiceSet, "uno1", "set"}));
    EXPECT_EQ(topics.parse("asip/uno1/set"), std::nullopt);
}

TEST(Topics, ForeignOrInvalid_IsNothing) {
    const Topics topics;
    const std::string too_long(65, 'x');
    for (const std::string& topic : {std::string(),
                                     std::string("asip"),
                                     std::string("asip/"),
                                     std::string("asip//in"),
                                     std::string("other/uno1/in"),
                                     std::string("asipx/uno1/in"),
                                     std::string("asip/uno1"),
                                     std::string("asip/uno1/sideways"),
                                     std::string("asip/uno1/io/sideways"),
                                     std::string("asip/uno1/io/in/more"),
                                     std::string("asip/servicebus/uno1/$demand"),
                                     std::string("asip/servicebus/uno1/$demand/ann"),
                                     std::string("asip/servicebus/uno1/$demand/ann/"),
                                     std::string("asip/servicebus/uno1/$demand//c1"),
                                     std::string("asip/servicebus/uno1/$demand/ann/c1/x"),
                                     std::string("asip/servicebus/a b/$demand/ann/c1"),
                                     "asip/servicebus/uno1/$demand/ann/" + std::string(200, 'x'),
                                     std::string("asip/uno 1/in"),
                                     std::string("asip/un\0o/in", 12),
                                     std::string("asip/+/in"),
                                     std::string("asip/$SYS/in"),
                                     "asip/" + too_long + "/in",
                                     "asip/uno1/" + too_long + "/in",
                                     std::string("asip/servicebus/servicebus"),
                                     std::string("asip/servicebus/registry/$state"),
                                     std::string("asip/servicebus/uno1/$other"),
                                     std::string("asip/servicebus/$probe/x"),
                                     std::string("asip/servicebus/"),
                                     std::string("asip/registry/in"),
                                     std::string("asip/registry/r1"),
                                     std::string("asip/registry/r 1/$state"),
                                     std::string("asip/uno1/in/")}) {
        EXPECT_FALSE(topics.parse(topic)) << topic;
    }
}

TEST(TopicRoot, InvalidRoot_IsRefused) {
    for (const char* root : {"", "/a", "a/", "a//b", "a/+", "#", "$a", "a\nb"}) {
        EXPECT_FALSE(Topics::valid_root(root)) << root;
        EXPECT_THROW(Topics{root}, std::invalid_argument);
    }
    EXPECT_FALSE(Topics::valid_root(std::string(129, 'a')));
    EXPECT_TRUE(Topics::valid_root("plant/line-1/asip"));
}

}  // namespace
}  // namespace asip::bus
