// SPDX-License-Identifier: Apache-2.0
// Published clients leave out line ends. While no extension is in use a request also ends where the next one
// begins, and after a second of silence. tests/firmware tries each short input.
#include <gtest/gtest.h>

#include "fake_board.hpp"

namespace asip {
namespace {

/// Keeps what it is told: T,t,a,b and T,s.
class Told : public Service {
  public:
    Told() : Service('T', 1) {}
    FlashText name() const override { return F("Told"); }
    void begin() override {}
    Error processRequest(Request& request) override {
        if (request.tag() == 's') {
            if (!request.complete()) return Error::kBadArgument;
            told += "s;";
            return Error::kNone;
        }
        if (request.tag() != 't') return Error::kUnknownRequest;
        const auto a = request.number();
        const auto b = request.signedNumber();
        if (!request.complete()) return Error::kBadArgument;
        told += std::to_string(a) + "," + std::to_string(b) + ";";
        return Error::kNone;
    }
    void reportValue(uint8_t) override {}
    std::string told;
};

struct WithoutLineEnd : testing::Test {
    std::string told() { return std::exchange(service.told, {}); }
    Told service;
    FakeBoard board{{&service}};
};

TEST_F(WithoutLineEnd, Request_EndsWhereTheNextBegins) {
    EXPECT_EQ(board.send("T,t,1,100T,t,0,-100T,A,25"), "");
    EXPECT_EQ(told(), "1,100;0,-100;");
    EXPECT_EQ(service.period(), 0) << "the last one has not ended";
    board.send("T,sT,");
    EXPECT_EQ(service.period(), 25);
    EXPECT_EQ(told(), "s;");
}

TEST_F(WithoutLineEnd, Request_EndsAfterASecondOfSilence) {
    board.send("T,t,1,100");
    board.pass_time(990);
    EXPECT_EQ(told(), "");
    EXPECT_EQ(board.pass_time(30), "");
    EXPECT_EQ(told(), "1,100;");
    EXPECT_EQ(board.pass_time(5000), "") << "once";
    EXPECT_EQ(board.send("\nT,s\n"), "");
    EXPECT_EQ(told(), "s;");
}

TEST_F(WithoutLineEnd, HalfAName_IsNotStoredAfterSilence) {
    board.send("#,I,un");
    EXPECT_EQ(board.pass_time(1100), "~#,I,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.ask("#,I"), "@#,I,\n");
    board.send("#,?");
    EXPECT_NE(board.pass_time(1100).find("@#,?,0,4"), std::string::npos);
}

TEST_F(WithoutLineEnd, PeerThatLeaves_EndsTheUseOfExtensions) {
    for (const char* leave : {"#,B,57600\n", "#,C,0\n"}) {
        board.ask("#,E,t");
        board.send(leave);
        board.pass_time(10);
        board.send("T,t,1,100T,t,0,50\n");
        EXPECT_EQ(told(), "1,100;0,50;") << leave;
    }
    board.ask("#,C,1");
    board.send("#,C,0*50\n");
    board.send("T,t,1,100T,t,0,50\n");
    EXPECT_EQ(told(), "1,100;0,50;");
}

}  // namespace
}  // namespace asip
