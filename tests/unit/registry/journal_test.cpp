#include "registry/history/journal.hpp"

#include <gmock/gmock.h>

#include "bus_messages.hpp"
#include "history_files.hpp"

namespace asip::registry {
namespace {

using model::BoardState;
using testing::IsEmpty;

const JournalBoard kOnline{wall(1000), wall(1000), BoardState::kOnline};

void put(Catalogue& catalogue, const OwnedMessage& message) {
    ASSERT_FALSE(catalogue.apply(message.view(), at(0s)).refused);
}

std::vector<std::string> texts(const Journal::Rows& rows) {
    std::vector<std::string> result;
    for (const auto& row : rows) {
        std::string text = row.board + " " + row.what;
        if (row.what == "state") text += " " + row.was + "->" + row.state;
        if (row.what == "added") text += " " + row.state;
        result.push_back(text + (row.reason.empty() ? "" : " " + row.reason));
    }
    return result;
}

TEST(Journal, RegistryStartsAgain_BoardsThatStayedLeaveNoRow) {
    Journal journal({{"uno1", kOnline}});
    Catalogue catalogue;
    put(catalogue, description("uno1"));
    Journal::Rows rows;
    journal.change({Event::Kind::kAdded, "uno1", 1, BoardState::kLost}, wall(5000), rows);
    journal.change({Event::Kind::kState, "uno1", 2, BoardState::kOnline}, wall(5000), rows);
    journal.complete(catalogue, wall(6000), rows);
    EXPECT_THAT(texts(rows), IsEmpty());
    EXPECT_EQ(*journal.find("uno1"), kOnline);
}

TEST(Journal, RegistryStartsAgain_WhatChangedMeanwhileIsOneRow) {
    Journal journal({{"uno1", kOnline}, {"uno2", kOnline}});
    Catalogue catalogue;
    put(catalogue, description("uno1"));
    put(catalogue, state("uno1", "offline"));
    put(catalogue, description("uno3"));
    Journal::Rows rows;
    journal.complete(catalogue, wall(6000), rows);
    EXPECT_THAT(texts(rows), testing::UnorderedElementsAre("uno1 state online->offline retained",
                                                           "uno3 added online retained"));
    EXPECT_EQ(journal.find("uno1")->since, wall(6000));
    EXPECT_EQ(journal.find("uno1")->first, wall(1000));
}

TEST(Journal, BoardHeardAgainAfterCompletion_IsNotAddedTwice) {
    Journal journal({{"esp1", {wall(1000), wall(2000), BoardState::kLost}}});
    Journal::Rows rows;
    journal.complete(Catalogue(), wall(6000), rows);
    journal.change(
        {Event::Kind::kAdded, "esp1", 1, BoardState::kOnline, BoardState::kLost, Event::Reason::kAnnounced},
        wall(7000), rows);
    EXPECT_THAT(texts(rows), testing::ElementsAre("esp1 state lost->online announced"));
}

TEST(Journal, NamesOnlyBoardThatLeftWhileNobodyListened_BecomesLost) {
    Journal journal({{"esp1", kOnline}, {"esp2", kOnline}});
    Catalogue catalogue;
    Journal::Rows rows;
    journal.complete(catalogue, wall(6000), rows);
    EXPECT_THAT(texts(rows), IsEmpty()) << "it may just be silent";
    put(catalogue, board_name("esp2"));
    journal.end_absent(catalogue, wall(70'000), rows);
    EXPECT_THAT(texts(rows), testing::ElementsAre("esp1 state online->lost lease"));
}

TEST(Journal, ForgottenBoardSeenAgain_IsAdded) {
    Journal journal({{"uno1", kOnline}});
    Journal::Rows rows;
    journal.complete(Catalogue(), wall(6000), rows);
    journal.change({Event::Kind::kForgotten, "uno1", 1, BoardState::kLost}, wall(7000), rows);
    EXPECT_EQ(journal.find("uno1"), nullptr);
    journal.change({Event::Kind::kAdded, "uno1", 2, BoardState::kOnline}, wall(8000), rows);
    EXPECT_THAT(texts(rows), testing::ElementsAre("uno1 forgotten", "uno1 added online"));
}

TEST(Journal, WhileReadingAgain_ConflictsAndForgettingAreWrittenAllTheSame) {
    Journal journal({{"uno1", kOnline}});
    Journal::Rows rows;
    journal.begin_reading();
    journal.change({Event::Kind::kConflict, "uno1", 1, BoardState::kOnline}, wall(7000), rows);
    journal.change({Event::Kind::kDescription, "uno1", 2, BoardState::kOnline}, wall(7000), rows);
    journal.change({Event::Kind::kForgotten, "uno1", 3, BoardState::kLost}, wall(7000), rows);
    EXPECT_THAT(texts(rows), testing::ElementsAre("uno1 conflict", "uno1 forgotten"));
}

}  // namespace
}  // namespace asip::registry
