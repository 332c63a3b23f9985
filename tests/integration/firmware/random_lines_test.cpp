// SPDX-License-Identifier: Apache-2.0
// 100,000 random and mutated lines: no board is reset or hung by any, and the next good line is answered.
#include <gtest/gtest.h>

#include <random>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

constexpr int kLines = 25000;  // on each of four boards
constexpr int kLinesBetweenFences = 50;

const char* const kGood[] = {"#,?",        "#,N",         "#,S",     "#,X",      "#,E,abc",  "#,I",
                             "#,R",        "I,M",         "I,m",     "I,p",      "I,c",      "I,P,3,5",
                             "I,P,13,3",   "I,P,2,2",     "I,d,2,1", "I,d,13,1", "I,a,3,99", "I,A,100",
                             "I,A,0",      "D,M",         "D,A,50",  "D,A,0",    "S,W,0,9",  "S,W,1,180",
                             "S,M,2,9,10", "S,M,3,4,5,6", "!note",   "#,I,name"};

// Lines that would change the line itself would only test the test.
bool is_of_the_line(const std::string& line) {
    return line.find("#,C") != std::string::npos || line.find("#,B") != std::string::npos;
}

std::string random_line(std::mt19937& random) {
    const auto below = [&](unsigned limit) { return random() % limit; };
    std::string line;
    if (below(4) == 0) {
        for (unsigned length = below(90); length > 0; --length)
            line.push_back(static_cast<char>(below(256)));
    } else {
        line = kGood[below(std::size(kGood))];
        for (unsigned mutations = below(4); mutations > 0; --mutations) {
            const auto at = below(static_cast<unsigned>(line.size() + 1));
            switch (below(4)) {
                case 0:
                    line.insert(at, 1, static_cast<char>(below(256)));
                    break;
                case 1:
                    line.insert(at, std::to_string(random()));
                    break;
                case 2:
                    line.erase(at, 1);
                    break;
                default:
                    if (at < line.size()) line[at] = static_cast<char>(line[at] ^ (1 << below(8)));
            }
        }
    }
    std::erase(line, '\n');
    return is_of_the_line(line) ? std::string("#") : line;
}

// A board that stores names from the flood is busy for a tenth of a second with each: what comes then may be
// lost, as on any board.
bool answers(FirmwareBoard& board, const std::string& request, const std::string& answer) {
    for (int attempt = 0; attempt < 30; ++attempt) {
        board->send(request);
        for (const auto& line : board.lines_within(milliseconds(60)))
            if (line.starts_with(answer)) return true;
    }
    return false;
}

class RandomLinesTest : public testing::TestWithParam<std::tuple<std::string, unsigned>> {};

TEST_P(RandomLinesTest, NeitherResetNorHang) {
    const auto [image, seed] = GetParam();
    FirmwareBoard board(image);
    const std::string fence = board.ask("#,X").starts_with("@") ? "#,E,f" : "#,?";
    const std::string fenced = fence == "#,?" ? "@#,?,0,4" : "@#,E,f";
    if (fence != "#,?") board.step_up(500000);
    std::mt19937 random(seed);
    std::string recent;
    for (int sent = 0; sent < kLines; sent += kLinesBetweenFences) {
        recent.clear();
        for (int i = 0; i < kLinesBetweenFences; ++i)
            recent += random_line(random) + "\n";
        // The flood overflows what the board can hold: that too it must survive.
        board->send(recent);
        ASSERT_TRUE(board->run_until([&] { return board->sending() == 0; }, milliseconds(5000)));
        ASSERT_TRUE(answers(board, "\n#,R\n" + fence + "\n", fenced)) << "after line " << sent << ", in:\n"
                                                                      << recent;
        ASSERT_EQ(board->resets(), 0u);
        ASSERT_TRUE(board->alive());
    }
    EXPECT_EQ(board.ask("I,P,13,3"), "");
    EXPECT_EQ(board.ask("I,d,13,1"), "");
    EXPECT_EQ(board->pin(13), sim::Level::kHigh);
}

INSTANTIATE_TEST_SUITE_P(Boards, RandomLinesTest,
                         testing::Values(std::tuple(std::string("asip_uno_services"), 1u),
                                         std::tuple(std::string("asip_uno_services"), 2u),
                                         std::tuple(std::string("asip_uno_serial"), 3u),
                                         std::tuple(std::string("asip_uno"), 4u)),
                         [](const auto& chosen) {
                             return std::get<0>(chosen.param) + "_" +
                                    std::to_string(std::get<1>(chosen.param));
                         });

}  // namespace
}  // namespace asip::firmware
