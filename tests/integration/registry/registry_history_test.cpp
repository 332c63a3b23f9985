// SPDX-License-Identifier: Apache-2.0
// What a registry with a history does when its clock or its disk is wrong for a while.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "running_registry.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::int64_t kYear = 365 * 24 * 3600;

/// How far ahead the clock of a program is that was started with environment().
class Clock {
  public:
    Clock() { set(0); }
    void set(std::int64_t seconds) const {
        std::fstream file(folder_.file("clock"), std::ios::binary | std::ios::in | std::ios::out);
        if (!file) file.open(folder_.file("clock"), std::ios::binary | std::ios::out);
        file.write(reinterpret_cast<const char*>(&seconds), sizeof seconds);
    }
    std::map<std::string, std::string> environment() const {
        return {{"LD_PRELOAD", STEPPED_CLOCK}, {"CLUSTER_CLOCK", folder_.file("clock")}};
    }

  private:
    TempDir folder_;
};

class RegistryWithHistory : public testing::Test {
  protected:
    RegistryWithHistory() : probe_(broker_.port()) {}

    void start() {
        process_.emplace(std::vector<std::string>{ASIP_REGISTRY_PROGRAM, "--broker", broker_.address(),
                                                  "--id", "r1", "--history", file_, "--config",
                                                  settings_file("history-age = 1d\nstats-interval = 1s\n")},
                         clock_.environment());
        ASSERT_TRUE(process_->wait_for_errors("catalogue is complete")) << process_->errors();
    }
    void stop() {
        process_->signal(15);
        ASSERT_EQ(process_->wait_exit(), 0);
    }
    void announce(const std::string& board, const std::string& state) {
        probe_.publish(announcement(board, description_text(board, "a", 1), 60));
        probe_.publish("asip/servicebus/" + board + "/$state", state, true, 1);
        ASSERT_TRUE(becomes(probe_, board, state));
    }
    std::size_t rows_of(const std::string& board) {
        const auto answer = ask(probe_, R"({"find":"history","board":")" + board + R"("})");
        return answer ? answer->history.size() : 0;
    }

    MosquittoBroker broker_;
    BusProbe probe_;
    TempDir folder_;
    Clock clock_;
    std::string file_ = folder_.file("history.db");
    std::optional<ChildProcess> process_;
};

TEST_F(RegistryWithHistory, ClockAYearAheadAndThenAYearBack_NothingIsErasedOrForgotten) {
    start();
    announce("uno1", "online");
    announce("uno2", "lost");
    ASSERT_TRUE(wait_until([&] { return rows_of("uno1") == 1 && rows_of("uno2") >= 1; }));
    const auto rows = rows_of("uno2");
    const auto board = ask(probe_, R"({"find":"boards","board":"uno2"})")->boards.at(0);
    stop();
    for (const std::int64_t ahead : {kYear, -kYear, std::int64_t{0}}) {
        clock_.set(ahead);
        start();
        const auto again = [&] { return ask(probe_, R"({"find":"boards","board":"uno2"})"); };
        ASSERT_FALSE(again()->boards.empty());
        EXPECT_LE(std::chrono::abs(again()->boards[0].first_seen - board.first_seen),
                  std::chrono::milliseconds(2))
            << ahead;
        clock_.set(ahead + kYear);  // while it runs
        // Rows are dropped at the start, and long lost boards forgotten 10 s later.
        const bool forgotten = wait_until([&] { return state_of(probe_, "uno2") != "lost"; },
                                          std::chrono::seconds(ahead == kYear ? 12 : 1));
        EXPECT_FALSE(forgotten) << ahead;
        EXPECT_EQ(rows_of("uno1"), 1u) << ahead;
        EXPECT_EQ(rows_of("uno2"), rows) << ahead;
        stop();
    }
}

TEST_F(RegistryWithHistory, FileIsDamaged_TheCatalogueIsThereAndANewHistoryIsBegun) {
    std::ofstream(file_) << std::string(8192, 'x');
    start();
    announce("uno1", "online");
    EXPECT_TRUE(wait_until([&] { return rows_of("uno1") == 1; }));
    EXPECT_TRUE(fs::exists(file_ + ".damaged"));
    EXPECT_THAT(process_->errors(), HasSubstr("history.db.damaged"));
    stop();
}

TEST_F(RegistryWithHistory, FileCannotBeUsedForAWhile_TheReasonIsAnsweredAndNothingIsLost) {
    fs::create_directories(file_);
    start();
    announce("uno1", "online");
    const auto refused = ask(probe_, R"({"find":"history"})");
    EXPECT_EQ(refused->refused, "no-history");
    EXPECT_THAT(refused->error, HasSubstr("it is a folder"));
    EXPECT_TRUE(probe_.wait_for([](const mqtt::Message& message) {
        return message.topic == "asip/registry/r1/$stats" &&
               message.payload.find("history_fault") != std::string::npos;
    }));
    fs::remove(file_);
    EXPECT_TRUE(process_->wait_for_errors("history is kept again"));
    EXPECT_TRUE(wait_until([&] { return rows_of("uno1") == 1; }));
    stop();
}

}  // namespace
}  // namespace asip::test
