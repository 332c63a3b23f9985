// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/board_texts.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::gateway::api {
namespace {

bus::BoardItem board_item(const std::string& name = "uno1") {
    bus::BoardItem board;
    board.board = name;
    board.state = board.reported = "online";
    board.last_seen = text::WallTime(std::chrono::milliseconds(1'700'000'000'123));
    board.age = 1.2345;
    board.description = R"({"board":"uno1","pins":{"modes":"11"}})";
    return board;
}

void expect_true(BoardTexts& texts, const bus::BoardItem& board) {
    EXPECT_EQ(nlohmann::json::parse(texts.text(board)), bus::to_json(board));
}

TEST(BoardTexts, AskedAgainAndAgain_EveryChangeIsInTheText) {
    BoardTexts texts;
    auto board = board_item();
    expect_true(texts, board);
    expect_true(texts, board);
    board.age = 0.004;
    board.last_seen += std::chrono::seconds(5);
    expect_true(texts, board);
    board.state = "lost";
    expect_true(texts, board);
    board.description = R"({"board":"uno1","pins":{"modes":"13"}})";
    expect_true(texts, board);
    bus::ServiceItem servo;
    servo.board = "uno1";
    servo.name = servo.kind = "servo";
    board.services.push_back(servo);
    expect_true(texts, board);
}

TEST(BoardTexts, BoardThatWasNeverHeard_HasNoAge) {
    BoardTexts texts;
    auto board = board_item();
    board.last_seen = {};
    expect_true(texts, board);
    board = board_item();
    expect_true(texts, board);
}

TEST(BoardTexts, MoreBoardsThanAreKept_EachHasItsOwnText) {
    BoardTexts texts;
    for (std::size_t i = 0; i < BoardTexts::kMaxBoards + 10; ++i)
        expect_true(texts, board_item("board" + std::to_string(i)));
    expect_true(texts, board_item("board0"));
}

}  // namespace
}  // namespace asip::gateway::api
