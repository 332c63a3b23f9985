// SPDX-License-Identifier: Apache-2.0
// The table of literal bytes on a model of ASIP 0.4, and on our firmware: both execute the same.
#include <gtest/gtest.h>

#include <memory>

#include "fake_board.hpp"
#include "tests/literal/literal_table.hpp"
#include "tests/literal/model_04.hpp"

namespace asip {
namespace {

using test::literal_rows;
using test::LiteralRow;
using Requests = std::vector<std::string>;

Requests of_model(const LiteralRow& row) {
    test::Model04 model;
    for (const auto& write : row.writes) {
        model.receive(write);
        model.pass(10);
    }
    model.pass(1100);
    return model.executed();
}

TEST(LiteralBytes, ModelOf04_ExecutesWhatTheTableSays) {
    for (const auto& row : literal_rows("serial"))
        EXPECT_EQ(of_model(row), row.executes) << row.name();
}

TEST(LiteralBytes, ModelOf04_MakesOneRequestOfTwoHalves) {
    test::Model04 model;
    model.receive("M,m,1,I,d,13,1\n");
    EXPECT_EQ(model.executed(), (Requests{"M,m,1,13"})) << "the fault that ours must not have";
}

// What was measured on its images.
TEST(LiteralBytes, ModelOf04_HasItsKnownFaults) {
    test::Model04 model;
    model.receive("I,M");
    model.pass(5000);
    EXPECT_EQ(model.take_executed(), Requests{}) << "fewer than four bytes sit until more come";
    model.receive("\n");
    EXPECT_EQ(model.take_executed(), Requests{"I,M"});
    model.receive("I,d,13\n");
    model.pass(500);
    EXPECT_EQ(model.take_executed(), Requests{}) << "it waits for the number that is missing";
    model.receive("I,P,2,1\n");
    EXPECT_EQ(model.take_executed(), Requests{"I,d,13,2"}) << "and takes it from the next request";
    model.receive("M,m,1,10");
    model.pass(999);
    EXPECT_EQ(model.take_executed(), Requests{});
    model.pass(1);
    EXPECT_EQ(model.take_executed(), Requests{"M,m,1,10"}) << "a number that is cut off ends after a second";
}

TEST(LiteralBytes, ModelOf04_SkipsWhatStandsBeforeARequestAndEndsItAnyhow) {
    test::Model04 model;
    model.receive(std::string(" \0\t\x1bI,d,13,1\r", 14));
    EXPECT_EQ(model.take_executed(), Requests{"I,d,13,1"});
    model.receive("!hello\nM,m,0,12.5\n I,a,9, 64\n\r");
    EXPECT_EQ(model.take_executed(), (Requests{"M,m,0,12", "I,a,9,64"}));
}

/// A service of a robot that notes each request that it takes.
class Noting final : public Service {
  public:
    Noting(char letter, Requests& noted) : Service(letter, 0), noted_(noted) {}
    FlashText name() const override { return F("Noting"); }
    void begin() override {}
    Error processRequest(Request& request) override {
        const char tag = request.tag();
        const int numbers = tag == 'A' ? 1 : tag == 'm' || tag == 'W' || tag == 'P' ? 2 : 0;
        std::string text{id(), ',', tag};
        for (int i = 0; i < numbers; ++i)
            text += ',' + std::to_string(request.signedNumber());
        if (!request.complete()) return Error::kBadArgument;
        noted_.push_back(text);
        return Error::kNone;
    }

  private:
    Requests& noted_;
};

/// What is executed: the services' requests as they note them, those of I and # by their answers.
struct Replay {
    explicit Replay(std::size_t split = std::string::npos) : split_at(split) {
        for (const char letter : {'M', 'E', 'R', 'B', 'S', 'D', 'T'})
            services.push_back(std::make_unique<Noting>(letter, noted));
        std::vector<Service*> all;
        for (auto& service : services)
            all.push_back(service.get());
        board = std::make_unique<FakeBoard>(all);
    }
    void send(const std::string& bytes) { answers += board->send(bytes); }
    void run(const std::string& bytes) {
        send(bytes.substr(0, std::min(split_at, bytes.size())));
        answers += board->pass_time(300);
        if (split_at < bytes.size()) send(bytes.substr(split_at));
        answers += board->pass_time(1100);
    }
    std::string state() const {
        std::string text = answers + "|";
        for (const auto& request : noted)
            text += request + ";";
        for (const bool level : board->hardware().levels)
            text += level ? '1' : '0';
        return text + std::to_string(asip::board.io().period());
    }
    std::size_t split_at;
    Requests noted;
    std::string answers;
    std::vector<std::unique_ptr<Noting>> services;
    std::unique_ptr<FakeBoard> board;
};

std::string state_after(const std::string& bytes, std::size_t split = std::string::npos) {
    Replay replay(split);
    replay.run(bytes);
    return replay.state();
}

std::string with_line_ends(const Requests& requests) {
    std::string all;
    for (const auto& request : requests)
        all += request + "\n";
    return all;
}

TEST(LiteralBytes, OurFirmware_DoesWhat04DoesWithThem) {
    for (const auto& row : literal_rows("serial"))
        EXPECT_EQ(state_after(row.bytes()), state_after(with_line_ends(row.executes))) << row.name();
}

TEST(LiteralBytes, OurFirmwareSplitAtEveryPlace_DoesTheSame) {
    for (const auto& row : literal_rows("serial")) {
        const auto expected = state_after(with_line_ends(row.executes));
        for (std::size_t at = 1; at < row.bytes().size(); ++at)
            ASSERT_EQ(state_after(row.bytes(), at), expected) << row.name() << " split at " << at;
    }
}

}  // namespace
}  // namespace asip
