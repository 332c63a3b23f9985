// SPDX-License-Identifier: Apache-2.0
// Announcements to a broker at which what is retained does not expire (MQTT 3.1.1).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;

/// A board that is online there.
struct RetainedForGood : testing::Test {
    RetainedForGood() {
        bench.plug();
        bench.connect(false);
        bench.pass(1500ms);
    }
    /// Whether the broker was to retain each message on the topic.
    std::vector<bool> retained_on(const std::string& topic) const {
        std::vector<bool> retained;
        for (const auto& publication : bench.published)
            if (publication.message.topic == topic) retained.push_back(publication.message.retain);
        return retained;
    }
    BridgeBench bench;
    const std::string state = "asip/servicebus/uno1/$state";
    const std::string description = "asip/servicebus/uno1/$description";
    const std::string probe = "asip/servicebus/$probe";
};

TEST_F(RetainedForGood, Announcement_IsRetainedOnceALease) {
    EXPECT_THAT(retained_on(state), ElementsAre(true));
    EXPECT_THAT(retained_on(description), ElementsAre(true));
    bench.published.clear();
    bench.hear(probe, "");
    bench.pass(1s);
    EXPECT_THAT(bench.on(state), ElementsAre("online"));
    EXPECT_THAT(retained_on(state), ElementsAre(false));
    EXPECT_THAT(retained_on(description), ElementsAre(false));
    bench.published.clear();
    bench.pass(58s);
    EXPECT_THAT(retained_on(description), Each(false)) << "leases are renewed all the same";
    bench.pass(22s);
    EXPECT_THAT(retained_on(description), Contains(true).Times(1));
}

TEST_F(RetainedForGood, ChangedOrOverwritten_IsRetainedAtOnce) {
    for (const std::string foreign : {"", "no json"}) {
        bench.published.clear();
        bench.hear(description, foreign);
        bench.hear(probe, "");
        bench.pass(1s);
        EXPECT_THAT(retained_on(description), ElementsAre(true)) << foreign;
    }
    bench.published.clear();
    bench.hear(state, "lost");
    EXPECT_THAT(retained_on(state), ElementsAre(true));
    bench.published.clear();
    bench.bridge.bus_disconnected();
    bench.connect(false);
    bench.pass(900ms);
    EXPECT_THAT(retained_on(state), ElementsAre(true));
    EXPECT_THAT(retained_on(description), ElementsAre(true));
}

}  // namespace
}  // namespace asip::agent
