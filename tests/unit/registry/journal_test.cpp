// SPDX-License-Identifier: Apache-2.0
#include "registry/history/journal.hpp"

#include <gmock/gmock.h>

#include "history_files.hpp"
#include "messages.hpp"

namespace asip::registry {
namespace journal_test {

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
    EXPECT_THAT(texts(rows),
                testing::UnorderedElementsAre("uno1 state online->offline stopped", "uno3 added online"));
    EXPECT_EQ(journal.find("uno1")->since, wall(6000));
    EXPECT_EQ(journal.find("uno1")->first, wall(1000));
}

TEST(Journal, BoardHeardAgainAfterCompletion_IsNotAddedTwice) {
    Journal journal({{"esp1", {wall(1000), wall(2000), BoardState::kLost}}});
    Journal::Rows rows;
    journal.complete(Catalogue(), wall(6000), rows);
    journal.change(
        {Event::Kind::kAdded, "esp1", 1, BoardState::kOnline, BoardState::kLost, model::StateReason::kNone},
        wall(7000), rows);
    EXPECT_THAT(texts(rows), testing::ElementsAre("esp1 state lost->online"));
}

TEST(Journal, NamesOnlyBoardThatLeftWhileNobodyListened_BecomesLost) {
    Journal journal({{"esp1", kOnline}, {"esp2", kOnline}});
    Catalogue catalogue;
    Journal::Rows rows;
    journal.complete(catalogue, wall(6000), rows);
    EXPECT_THAT(texts(rows), IsEmpty()) << "it may just be silent";
    put(catalogue, board_name("esp2"));
    journal.end_absent(catalogue, wall(70'000), rows);
    EXPECT_THAT(texts(rows), testing::ElementsAre("esp1 state online->lost expired"));
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

std::string command_note(const std::string& request, const std::string& by = "anna",
                         const std::string& status = "ok") {
    return R"({"what":"command","service":"servo","request":")" + request + R"(","by":")" + by +
           R"(","status":")" + status + "\"}";
}

TEST(Journal, Command_IsARowWithWhoSentIt) {
    const Journal journal({{"uno1", kOnline}});
    Journal::Rows rows;
    journal.command("uno1", command_note("W,0,90"), wall(5000), rows);
    ASSERT_EQ(rows.size(), 1u);
    bus::HistoryItem expected{"uno1", wall(5000), "command", "", "", ""};
    expected.by = "anna";
    expected.service = "servo";
    expected.request = "W,0,90";
    expected.status = "ok";
    EXPECT_EQ(rows[0], expected);
}

TEST(Journal, CommandsThatDifferInTheirArgumentsAlone_AreOneRowWithTheLastAndTheirCount) {
    const Journal journal({{"uno1", kOnline}});
    Journal::Rows rows;
    for (int angle = 0; angle < 180; ++angle) {
        journal.command("uno1", command_note("W,0," + std::to_string(angle)), wall(5000 + angle), rows);
        if (angle == 90) journal.command("uno1", command_note("W,0,90", "bert"), wall(5090), rows);
    }
    journal.command("uno1", command_note("W,0,181", "anna", "refused"), wall(5200), rows);
    journal.command("uno1", command_note("D,0"), wall(5200), rows);
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[0].by + rows[0].request, "annaW,0,179");
    EXPECT_EQ(rows[0].count, 180);
    EXPECT_EQ(rows[0].at, wall(5000));
    EXPECT_EQ(rows[1].by, "bert");
    EXPECT_EQ(rows[1].count, 0);
    EXPECT_EQ(rows[2].status, "refused");
    EXPECT_EQ(rows[3].request, "D,0");
}

TEST(Journal, CommandsOfALink_AreOneRowWithTheLastCause_HoweverLongTheirNames) {
    const Journal journal({{"uno1", kOnline}});
    Journal::Rows rows;
    const auto cause = [](int i) {
        return "link greenhouse-temperature-0-celsius-io-5, because greenhouse/temperature/0 was " +
               std::to_string(i);
    };
    for (int i = 0; i < 30; ++i)
        journal.command("uno1", command_note("W,0," + std::to_string(i), cause(i)), wall(5000), rows);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].by, cause(29));
    EXPECT_EQ(rows[0].count, 30);
}

TEST(Journal, WhatIsNoCommand_LeavesNoRow) {
    const Journal journal({{"uno1", kOnline}});
    Journal::Rows rows;
    const std::string good = command_note("W,0,90");
    journal.command("uno2", good, wall(1), rows);  // an unknown board
    for (const std::string& bad :
         {std::string(), std::string("[]"), std::string("{"), good + " " + good,
          std::string(5000, ' ') + good, command_note("W", ""), command_note("W", std::string(257, 'a')),
          command_note(std::string(129, 'W')), command_note("W", "anna", "fine"),
          std::string(R"({"what":"added","by":"anna","status":"ok"})"),
          std::string(R"({"what":"command","by":"anna","status":"ok","service":"a/b"})"),
          std::string(R"({"what":"command","by":7,"status":["ok"]})"),
          std::string("{\"what\":\"command\",\"by\":\"\xff\",\"status\":\"ok\"}")})
        journal.command("uno1", bad, wall(1), rows);
    EXPECT_THAT(texts(rows), IsEmpty());
    journal.command("uno1", good, wall(1), rows);
    EXPECT_EQ(rows.size(), 1u);
}

TEST(Journal, CommandThatClaimsAnotherBoardTimeOrState_HasThoseOfItsTopic) {
    const Journal journal({{"uno1", kOnline}});
    Journal::Rows rows;
    journal.command(
        "uno1",
        R"({"what":"stop","by":"anna","status":"ok","board":"uno2","at":"1999-01-01T00:00:00.000Z","state":"lost","was":"online","count":9})",
        wall(5000), rows);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].board, "uno1");
    EXPECT_EQ(rows[0].at, wall(5000));
    EXPECT_EQ(rows[0].state + rows[0].was, "");
    EXPECT_EQ(rows[0].count, 0);
}

}  // namespace journal_test
}  // namespace asip::registry
