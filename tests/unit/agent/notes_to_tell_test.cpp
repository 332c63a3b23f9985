// SPDX-License-Identifier: Apache-2.0
#include "agent/command/notes_to_tell.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

using namespace std::chrono_literals;

std::vector<mqtt::Message> one_note(const std::string& text) {
    return {mqtt::Message{.payload = text}};
}

TEST(NotesToTell, NoteOfALoneCommand_IsDueAMomentBehindItsAnswer) {
    NotesToTell notes;
    notes.add({}, Time{});
    EXPECT_FALSE(notes.next_deadline());
    notes.add(one_note("a"), Time{} + 5ms);
    EXPECT_EQ(notes.next_deadline(), Time{} + 5ms + NotesToTell::kQuiet);
    ASSERT_EQ(notes.take().size(), 1u);
    EXPECT_FALSE(notes.next_deadline());
    EXPECT_TRUE(notes.take().empty());
}

TEST(NotesToTell, CommandsThatFollowEachOther_AreToldTogetherInTheirOrderAndWithinABound) {
    NotesToTell notes;
    for (int i = 0; i < 10; ++i)
        notes.add(one_note(std::to_string(i)), Time{} + i * 1ms);
    EXPECT_EQ(notes.next_deadline(), Time{} + NotesToTell::kLongest);
    const auto told = notes.take();
    ASSERT_EQ(told.size(), 10u);
    for (std::size_t i = 0; i < told.size(); ++i)
        EXPECT_EQ(told[i].payload, std::to_string(i));
    notes.add(one_note("later"), Time{} + 1s);
    EXPECT_EQ(notes.next_deadline(), Time{} + 1s + NotesToTell::kQuiet) << "the ones before do not count";
}

}  // namespace
}  // namespace asip::agent
