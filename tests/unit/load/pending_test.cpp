// SPDX-License-Identifier: Apache-2.0
#include "bench/load/pending.hpp"

#include <gmock/gmock.h>

namespace asip::load {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

struct PendingTest : testing::Test {
    std::string add(Time sent, std::size_t kind) {
        mqtt::Message message;
        message.topic = "asip/registry/query";
        auto request = requester.ask(message, true, [](const mqtt::Message&) {});
        auto id = request.id();
        pending.add(std::move(request), sent, kind);
        return id;
    }

    bus::Requester requester{"test", bus::ReplyTopics(bus::Topics(), "", "test")};
    Pending pending;
    Time now = Time{} + 1h;
};

TEST_F(PendingTest, Answered_CountsOnce) {
    const auto id = add(now, 1);
    EXPECT_TRUE(pending.end(id));
    EXPECT_FALSE(pending.end(id));
    EXPECT_TRUE(pending.empty());
}

TEST_F(PendingTest, Overdue_AreForgottenByTheirKind) {
    const auto old = add(now, 3);
    add(now + 5s, 4);
    EXPECT_THAT(pending.forget_overdue(now + Pending::kPatience), IsEmpty());
    EXPECT_THAT(pending.forget_overdue(now + Pending::kPatience + 1s), ElementsAre(3));
    EXPECT_FALSE(pending.end(old)) << "its answer comes too late";
    EXPECT_THAT(pending.kinds(), ElementsAre(4));
}

TEST_F(PendingTest, TooMany_AreFull) {
    for (std::size_t i = 0; i < Pending::kMax; ++i) {
        EXPECT_FALSE(pending.full());
        add(now, 0);
    }
    EXPECT_TRUE(pending.full());
}

}  // namespace
}  // namespace asip::load
