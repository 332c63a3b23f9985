// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/outbox.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace asip::mqtt {
namespace {

constexpr std::size_t kPlenty = 1000000;

Message message(std::string topic, std::string payload, bool retain = false) {
    return Message{.topic = std::move(topic), .payload = std::move(payload), .retain = retain};
}

std::string drain(Outbox& outbox) {
    std::string payloads;
    while (!outbox.empty())
        payloads += outbox.pop().message.payload + " ";
    return payloads;
}

TEST(Outbox, DifferentPriorities_LeaveInTheOrderTheyCame) {
    Outbox outbox({10, kPlenty});
    outbox.push(message("c", "1"), Priority::kContext);
    outbox.push(message("a", "2"), Priority::kAnnouncement);
    outbox.push(message("r", "3"), Priority::kReply);
    outbox.push(message("c", "4"), Priority::kContext);
    EXPECT_EQ(drain(outbox), "1 2 3 4 ");
    EXPECT_EQ(outbox.bytes(), 0u);
}

TEST(Outbox, Urgent_LeavesAheadOfAllThatWaitsAndInItsOwnOrder) {
    Outbox outbox({10, kPlenty});
    outbox.push(message("c", "1"), Priority::kContext);
    outbox.push(message("r", "2"), Priority::kReply);
    outbox.push(message("s", "stopped"), Priority::kUrgent);
    outbox.push(message("r", "3"), Priority::kReply);
    outbox.push(message("s", "again"), Priority::kUrgent);
    EXPECT_EQ(drain(outbox), "stopped again 1 2 3 ");
}

TEST(Outbox, UrgentNotDelivered_IsPutBackAheadOfTheOthers) {
    Outbox outbox({10, kPlenty});
    outbox.push(message("r", "1"), Priority::kReply);
    outbox.push(message("s", "stopped"), Priority::kUrgent);
    auto entry = outbox.pop();
    outbox.push(message("s", "again"), Priority::kUrgent);
    outbox.put_back(std::move(entry));
    EXPECT_EQ(drain(outbox), "stopped again 1 ");
}

TEST(Outbox, FullOfReplies_StillTakesWhatIsUrgent) {
    Outbox outbox({2, kPlenty});
    while (outbox.push(message("r", "reply"), Priority::kReply)) {
    }
    EXPECT_TRUE(outbox.push(message("s", "stopped"), Priority::kUrgent));
    EXPECT_TRUE(outbox.push(message("s", "stopped"), Priority::kUrgent));
    EXPECT_FALSE(outbox.push(message("s", "stopped"), Priority::kUrgent)) << "bounded, too";
    EXPECT_EQ(outbox.pop().message.payload, "stopped");
}

TEST(Outbox, Full_DropsTheOldestContextOnly) {
    Outbox outbox({3, kPlenty});
    outbox.push(message("r", "reply"), Priority::kReply);
    for (int i = 0; i < 5; ++i)
        EXPECT_TRUE(outbox.push(message("c", std::to_string(i)), Priority::kContext));
    EXPECT_EQ(outbox.dropped(), 3u);
    EXPECT_EQ(drain(outbox), "reply 3 4 ");
}

TEST(Outbox, FullByBytes_DropsUntilTheNewestFits) {
    Outbox outbox({100, 30});
    outbox.push(message("c", "123456789"), Priority::kContext);
    outbox.push(message("c", "abcdefghi"), Priority::kContext);
    EXPECT_TRUE(outbox.push(message("c", std::string(20, 'x')), Priority::kContext));
    EXPECT_EQ(drain(outbox), std::string(20, 'x') + " ");
    EXPECT_EQ(outbox.dropped(), 2u);
}

TEST(Outbox, LargerThanTheBound_IsRefused) {
    Outbox outbox({100, 30});
    EXPECT_FALSE(outbox.push(message("c", std::string(31, 'x')), Priority::kContext));
    EXPECT_TRUE(outbox.push(message("r", std::string(50, 'x')), Priority::kReply));
    EXPECT_FALSE(outbox.push(message("r", std::string(50, 'x')), Priority::kReply));
}

TEST(Outbox, FullOfReplies_TakesTwiceTheBoundThenRefuses) {
    Outbox outbox({3, kPlenty});
    for (int i = 0; i < 6; ++i)
        EXPECT_TRUE(outbox.push(message("r", std::to_string(i)), Priority::kReply));
    EXPECT_FALSE(outbox.push(message("r", "6"), Priority::kAnnouncement));
    EXPECT_FALSE(outbox.push(message("c", "c"), Priority::kContext));
    EXPECT_EQ(drain(outbox), "0 1 2 3 4 5 ");
    EXPECT_TRUE(outbox.push(message("c", "again"), Priority::kContext));
}

TEST(Outbox, RetainedOfTheSameTopic_ReplacesTheOlder) {
    Outbox outbox({10, kPlenty});
    outbox.push(message("state", "old", true), Priority::kAnnouncement);
    outbox.push(message("c", "value"), Priority::kContext);
    outbox.push(message("state", "new", true), Priority::kAnnouncement);
    EXPECT_EQ(drain(outbox), "value new ");
    outbox.push(message("c", "1"), Priority::kContext);
    outbox.push(message("c", "2"), Priority::kContext);
    EXPECT_EQ(drain(outbox), "1 2 ");
}

TEST(Outbox, RetainedThatExpires_IsReplacedInItsPlaceSoThatItLeavesHoweverOftenItIsRenewed) {
    Outbox outbox({10, kPlenty});
    auto lease = message("description", "1", true);
    lease.expiry_seconds = 60;
    outbox.push(lease, Priority::kAnnouncement);
    outbox.push(message("name", "board"), Priority::kAnnouncement);
    lease.payload = "longer";
    const auto before = outbox.bytes();
    outbox.push(lease, Priority::kAnnouncement);
    EXPECT_EQ(outbox.size(), 2u);
    EXPECT_EQ(outbox.bytes(), before + 5);
    EXPECT_EQ(drain(outbox), "longer board ");
    EXPECT_EQ(outbox.bytes(), 0u);
    outbox.push(lease, Priority::kAnnouncement);
    EXPECT_EQ(drain(outbox), "longer ");
}

TEST(Outbox, RetainedOfQos0_DoesNotTakeTheAcknowledgementFromTheOneThatWaits) {
    for (const bool expires : {false, true}) {
        Outbox outbox({10, kPlenty});
        auto announcement = message("a", "first", true), renewal = message("a", "renewed", true);
        announcement.qos = 1;
        if (expires) announcement.expiry_seconds = renewal.expiry_seconds = 60;
        outbox.push(announcement, Priority::kAnnouncement);
        outbox.push(renewal, Priority::kAnnouncement);
        auto entry = outbox.pop();
        EXPECT_EQ(entry.message.payload, "renewed");
        EXPECT_EQ(entry.message.qos, 1);
        outbox.push(renewal, Priority::kAnnouncement);
        outbox.put_back(std::move(entry));
        EXPECT_EQ(outbox.pop().message.qos, 1);
        EXPECT_TRUE(outbox.empty());
    }
}

TEST(Outbox, NotRetainedWithExpiry_ExpiresAndIsSentWithWhatIsLeft) {
    Outbox outbox({10, kPlenty});
    const Time begin{};
    auto command = message("in", "move");
    command.expiry_seconds = 5;
    outbox.push(command, Priority::kReply, begin);
    auto entry = outbox.pop();
    entry.age(begin);
    EXPECT_EQ(entry.message.expiry_seconds, 5u);
    entry.age(begin + std::chrono::milliseconds(999));
    EXPECT_EQ(entry.message.expiry_seconds, 5u) << "it has hardly waited";
    entry.age(begin + std::chrono::milliseconds(3500));
    EXPECT_EQ(entry.message.expiry_seconds, 1u) << "not more than there is";
    EXPECT_FALSE(entry.expired(begin + std::chrono::seconds(4)));
    EXPECT_TRUE(entry.expired(begin + std::chrono::milliseconds(4001))) << "less than MQTT can say";
    EXPECT_TRUE(entry.expired(begin + std::chrono::seconds(5)));
    outbox.put_back(entry);
    entry = outbox.pop();
    EXPECT_TRUE(entry.expired(begin + std::chrono::seconds(5))) << "since it was published first";
    entry.age(begin + std::chrono::seconds(9));
    EXPECT_EQ(entry.message.expiry_seconds, 1u);
}

TEST(Outbox, WithoutExpiryOrRetained_NeverExpires) {
    Outbox outbox({10, kPlenty});
    auto lease = message("description", "1", true);
    lease.expiry_seconds = 60;
    outbox.push(lease, Priority::kAnnouncement, Time{});
    outbox.push(message("c", "1"), Priority::kContext, Time{});
    for (int i = 0; i < 2; ++i) {
        auto entry = outbox.pop();
        const auto expiry = entry.message.expiry_seconds;
        entry.age(Time{} + std::chrono::hours(1));
        EXPECT_FALSE(entry.expired(Time{} + std::chrono::hours(1)));
        EXPECT_EQ(entry.message.expiry_seconds, expiry);
    }
}

TEST(Outbox, PutBack_TakesItsOldPlace) {
    Outbox outbox({10, kPlenty});
    for (const char* payload : {"1", "2", "3"})
        outbox.push(message("r", payload), Priority::kReply);
    auto first = outbox.pop();
    auto second = outbox.pop();
    outbox.put_back(std::move(second));
    outbox.put_back(std::move(first));
    EXPECT_EQ(drain(outbox), "1 2 3 ");
}

TEST(Outbox, PutBackRetained_YieldsToTheNewerInWhicheverOrder) {
    Outbox outbox({10, kPlenty});
    outbox.push(message("s", "1", true), Priority::kAnnouncement);
    auto first = outbox.pop();
    outbox.push(message("s", "2", true), Priority::kAnnouncement);
    auto second = outbox.pop();
    auto first_again = first;
    auto second_again = second;
    outbox.put_back(std::move(first));
    outbox.put_back(std::move(second));
    EXPECT_EQ(drain(outbox), "2 ");
    outbox.put_back(std::move(second_again));
    outbox.put_back(std::move(first_again));
    EXPECT_EQ(drain(outbox), "2 ");
}

TEST(Outbox, Discard_RemovesOnePriority) {
    Outbox outbox({10, kPlenty});
    outbox.push(message("s", "state", true), Priority::kAnnouncement);
    outbox.push(message("r", "reply"), Priority::kReply);
    outbox.discard(Priority::kAnnouncement);
    EXPECT_EQ(outbox.size(), 1u);
    outbox.push(message("s", "state", true), Priority::kAnnouncement);
    EXPECT_EQ(drain(outbox), "reply state ");
}

}  // namespace
}  // namespace asip::mqtt
