// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/board_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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

constexpr std::size_t kLongText = 6'000;
constexpr std::size_t kMaxBytes = 200'000;

/// How many boards with a long text have half as many bytes again as the bound.
constexpr std::size_t boards_beyond(std::size_t max_bytes) {
    return max_bytes / kLongText * 3 / 2;
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

TEST(BoardTexts, BoardsWithLongDescriptions_AreKeptUpToANumberOfBytes) {
    BoardTexts texts(kMaxBytes);
    std::size_t largest = 0;
    for (std::size_t i = 0; i < boards_beyond(kMaxBytes); ++i) {
        auto board = board_item("b" + std::to_string(i));
        board.description = R"({"x":")" + std::string(kLongText, 'x') + R"("})";
        texts.text(board);
        largest = std::max(largest, texts.bytes());
    }
    EXPECT_GT(largest, kMaxBytes / 2);
    EXPECT_LT(largest, kMaxBytes + 30'000);
    auto board = board_item("b0");
    for (std::size_t i = 0; i < boards_beyond(kMaxBytes); ++i) {  // of one board, each other than
                                                                  // the last
        board.description = R"({"x":")" + std::string(kLongText - i, 'x') + R"("})";
        texts.text(board);
    }
    EXPECT_LT(texts.bytes(), kMaxBytes + 30'000);
    expect_true(texts, board);
}

TEST(BoardModels, BoardsWithLongDescriptions_AreKeptUpToANumberOfBytes) {
    const model::ModelSet none;
    BoardModels models(none, kMaxBytes);
    std::size_t largest = 0;
    for (std::size_t i = 0; i < boards_beyond(kMaxBytes); ++i) {
        auto board = board_item("b" + std::to_string(i));
        board.services.resize(1);
        board.services[0].name = "servo";
        models.find(board, "servo", [] { return R"({"x":")" + std::string(kLongText, 'x') + R"("})"; });
        largest = std::max(largest, models.bytes());
    }
    EXPECT_GT(largest, kMaxBytes / 2);
    EXPECT_LT(largest, kMaxBytes + 100'000);
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
