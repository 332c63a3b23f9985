// SPDX-License-Identifier: Apache-2.0
// What a registry with a history does when its clock or its disk is wrong for a while.
#include <gmock/gmock.h>

#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "running_registry.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

const std::string kStatistics = "asip/registry/r1/$stats";
constexpr std::int64_t kYear = 365 * 24 * 3600;

/// How far ahead the clock of a program is that was started with environment().
class Clock {
  public:
    Clock() { set(0), run(); }
    void set(std::int64_t seconds) const { write(0, seconds); }
    /// For the program no time passes, but for what it asks its timers.
    void stand() const {
        const auto now = std::chrono::steady_clock::now().time_since_epoch();
        write(1, std::chrono::nanoseconds(now).count());
    }
    void run() const { write(1, 0); }
    std::map<std::string, std::string> environment() const {
        return {{"LD_PRELOAD", STEPPED_CLOCK}, {"CLUSTER_CLOCK", folder_.file("clock")}};
    }

  private:
    void write(int place, std::int64_t number) const {
        std::fstream file(folder_.file("clock"), std::ios::binary | std::ios::in | std::ios::out);
        if (!file) file.open(folder_.file("clock"), std::ios::binary | std::ios::out);
        file.seekp(place * static_cast<std::streamoff>(sizeof number));
        file.write(reinterpret_cast<const char*>(&number), sizeof number);
    }
    TempDir folder_;
};

class RegistryWithHistory : public testing::Test {
  protected:
    RegistryWithHistory() : probe_(broker_.port()) {}

    void start() {
        // A file that may not grow is an error to the program, and not its end.
        process_.emplace(
            std::vector<std::string>{"sh", "-c", "trap '' XFSZ; exec \"$@\"", "sh",
                                     program_to_start(ASIP_REGISTRY_PROGRAM), "--broker", broker_.address(),
                                     "--id", "r1", "--history", file_, "--config",
                                     settings_file("history-age = 1d\nstats-interval = 1s\n")},
            environment());
        ASSERT_TRUE(process_->wait_for_errors("catalogue is complete")) << process_->errors();
    }
    std::map<std::string, std::string> environment() const {
        auto result = clock_.environment();
        result["LD_PRELOAD"] += ":" SLOW_DISK;
        result["ASIP_STALL"] = stall_;
        return result;
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

    MosquittoBroker broker_{{.extra_lines = {"max_queued_messages 0"}}};  // as in the configuration that is
                                                                          // shipped
    BusProbe probe_;
    TempDir folder_;
    Clock clock_;
    std::string file_ = folder_.file("history.db");
    std::string stall_ = folder_.file("stall");
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

/// A board with a named service, whose values are kept without a configuration.
class RegistryWithValues : public RegistryWithHistory {
  protected:
    void announce_named(const std::string& board) {
        auto text = description_text(board, "a", 1);
        text.insert(text.size() - 1, R"(,"names":{"services":{"distance":"front"}})");
        probe_.publish(announcement(board, text, 60));
        probe_.publish("asip/servicebus/" + board + "/$state", "online", true, 1);
        ASSERT_TRUE(becomes(probe_, board, "online"));
    }
    void say(const std::string& board, double value) {
        probe_.publish("asip/" + board + "/$values",
                       R"({"version":1,"board":")" + board + R"(","session":"a","seq":)" +
                           std::to_string(++seq_) + R"(,"values":{"distance/0":{"value":)" +
                           std::to_string(value) + R"(,"how":"reported","age":0}}})",
                       true, 1);
    }
    /// `ahead`: by the clock of the registry.
    std::vector<bus::ValuePoint> points(const std::string& board, std::int64_t ahead = 0) {
        const auto now = text::wall_now() + std::chrono::seconds(ahead);
        const auto answer = ask(probe_, R"({"find":"values","property":"distance/0","board":")" + board +
                                            R"(","from":")" + text::iso_time(now - std::chrono::hours(1)) +
                                            R"(","to":")" + text::iso_time(now) + R"("})");
        return answer ? answer->values : std::vector<bus::ValuePoint>();
    }
    bool is_kept(double value, std::int64_t ahead = 0) {
        return wait_until(
            [&] {
                const auto all = points("desk", ahead);
                return std::any_of(all.begin(), all.end(),
                                   [&](const auto& point) { return point.known && point.max == value; });
            },
            std::chrono::seconds(30));
    }
    void limit_files(rlim_t bytes) {
        const rlimit limit{bytes, RLIM_INFINITY};
        ASSERT_EQ(::prlimit(process_->pid(), RLIMIT_FSIZE, &limit, nullptr), 0);
    }
    std::string refusal_of_values() {
        const auto answer = ask(probe_, R"({"find":"values"})");
        return answer ? answer->refused + ": " + answer->error : "no answer";
    }
    void cut_power() {
        process_->signal(9);
        process_->wait_exit();
    }

    int seq_ = 0;
};

TEST_F(RegistryWithValues, KilledTwice_WhatWasKeptIsThereWithGapsBetween) {
    start();
    announce_named("desk");
    for (const double value : {20.5, 21.5, 22.5}) {
        say("desk", value);
        ASSERT_TRUE(is_kept(value)) << process_->errors();
        cut_power();
        start();
    }
    const auto all = points("desk");
    std::vector<double> known;
    std::size_t gaps = 0;
    for (const auto& point : all) {
        if (point.known && (known.empty() || known.back() != point.mean)) known.push_back(point.mean);
        gaps += point.known ? 0 : 1;
    }
    EXPECT_EQ(known, (std::vector<double>{20.5, 21.5, 22.5}));
    EXPECT_GE(gaps, 2u);
    const auto kept = ask(probe_, R"({"find":"values"})");
    ASSERT_TRUE(kept);
    EXPECT_EQ(kept->kept, (std::vector<bus::KeptProperty>{{"desk", "distance/0"}}));
    stop();
}

TEST_F(RegistryWithValues, FileDamagedOrNotThere_TheRestGoesOn) {
    const auto file = folder_.file("history.values.db");
    fs::create_directories(file);
    start();
    announce_named("desk");
    say("desk", 1);
    const auto refused = ask(probe_, R"({"find":"values"})");
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->refused, "history-fault");
    EXPECT_EQ(rows_of("desk"), 1u);
    EXPECT_THAT(process_->errors(), HasSubstr("values cannot be kept"));
    stop();
    fs::remove(file);
    std::ofstream(file) << std::string(8192, 'x');
    start();
    EXPECT_TRUE(is_kept(1));
    EXPECT_TRUE(fs::exists(file + ".damaged"));
    const auto unknown = ask(probe_, R"({"find":"values","board":"desk","property":"none","from":)"
                                     R"("2026-01-01T00:00:00.000Z","to":"2026-01-02T00:00:00.000Z"})");
    EXPECT_EQ(unknown->refused + unknown->level, "");
    EXPECT_TRUE(unknown->values.empty());
    stop();
}

TEST_F(RegistryWithValues, DiskIsFullForAWhile_TheRestGoesOnAndNothingIsLost) {
    start();
    announce_named("desk");
    say("desk", 1);
    ASSERT_TRUE(is_kept(1)) << process_->errors();
    limit_files(4096);  // less than there is
    say("desk", 2);
    ASSERT_TRUE(process_->wait_for_errors("values cannot be kept", std::chrono::seconds(30)));
    EXPECT_THAT(refusal_of_values(), HasSubstr("history-fault: values cannot be read now"));
    announce("uno1", "online");
    EXPECT_TRUE(probe_.wait_for([](const mqtt::Message& message) {
        return message.topic == "asip/registry/r1/$stats" &&
               message.payload.find("values_fault") != std::string::npos;
    }));
    say("desk", 3);
    limit_files(RLIM_INFINITY);
    EXPECT_TRUE(
        process_->wait_for_errors("values are kept again  .*changes lost=0", std::chrono::seconds(60)))
        << process_->errors();
    for (const double value : {1, 2, 3})
        EXPECT_TRUE(is_kept(value)) << value;
    EXPECT_TRUE(wait_until([&] { return rows_of("uno1") == 1; }, std::chrono::seconds(60)));
    EXPECT_FALSE(fs::exists(folder_.file("history.values.db.damaged")));
    stop();
}

TEST_F(RegistryWithValues, DiskStalls_TheRestGoesOnTheRefusalSaysWhyAndNothingIsLost) {
    start();
    announce_named("desk");
    say("desk", 1);
    ASSERT_TRUE(is_kept(1)) << process_->errors();
    folder_.write("stall", "");
    say("desk", 2);
    ASSERT_TRUE(wait_until([&] { return fs::exists(stall_ + ".met"); }, std::chrono::seconds(30)));
    announce("uno1", "online");
    ASSERT_TRUE(process_->wait_for_errors("values cannot be kept", std::chrono::seconds(60)));
    EXPECT_THAT(refusal_of_values(), HasSubstr("history-fault: values cannot be read now"));
    EXPECT_THAT(refusal_of_values(), HasSubstr("the disk has not answered"));
    say("desk", 3);
    announce("uno2", "online");
    fs::remove(stall_);
    EXPECT_TRUE(
        process_->wait_for_errors("values are kept again  .*changes lost=0", std::chrono::seconds(60)))
        << process_->errors();
    for (const double value : {1, 2, 3})
        EXPECT_TRUE(is_kept(value)) << value;
    EXPECT_TRUE(wait_until([&] { return rows_of("uno2") == 1; }, std::chrono::seconds(60)));
    stop();
}

TEST_F(RegistryWithValues, ClockAYearAheadAndAYearBack_WhatWasKeptStaysWhereItWas) {
    double value = 0;
    for (const std::int64_t ahead : {std::int64_t{0}, kYear, -kYear}) {
        clock_.set(ahead);
        start();
        announce_named("desk");
        say("desk", ++value);
        EXPECT_TRUE(is_kept(value, ahead)) << ahead << process_->errors();
        stop();
    }
    clock_.set(0);
    start();
    EXPECT_TRUE(is_kept(1));
    EXPECT_TRUE(is_kept(2, kYear));
    EXPECT_TRUE(is_kept(3, -kYear));
    stop();
}

std::string other_services(int seq) {
    std::string services;
    for (int i = 0; i < 20; ++i)
        services += (i == 0 ? "" : ",") + (R"({"name":"s)" + std::to_string(i)) +
                    R"(","id":"D","model":"distance@1","title":"A thing )" + std::to_string(seq % 2) + "\"}";
    return R"({"board":"uno1","session":"a","seq":)" + std::to_string(seq) + R"(,"lease":60,"services":[)" +
           services + "]}";
}

// Each is a row of the history and an event for watchers. A share is one of the time that passes: none does.
TEST_F(RegistryWithHistory, FloodOfOneBoard_CostsItsShareAlone_AndTheLastStateCounts) {
    constexpr int kFlood = 8000;
    start();
    announce("uno1", "online");
    process_->signal(SIGSTOP);  // all of them wait, however slowly they are sent
    for (int i = 0; i < kFlood; ++i)
        probe_.publish("asip/servicebus/uno1/$description", other_services(i + 2), false, 0);
    probe_.publish("asip/servicebus/uno1/$state", "sleeping");
    ASSERT_TRUE(wait_until([&] { return probe_.all_acknowledged(); }));
    clock_.stand();
    process_->signal(SIGCONT);
    EXPECT_TRUE(ask(probe_, R"({"find":"boards","limit":1})")) << process_->errors();
    clock_.run();
    EXPECT_TRUE(becomes(probe_, "uno1", "sleeping"));
    const auto told = probe_.count(kStatistics);
    ASSERT_TRUE(wait_until([&] { return probe_.count(kStatistics) > told + 1; }));
    EXPECT_LT(json::parse(*probe_.last(kStatistics))["messages"], kFlood / 2);
}

TEST_F(RegistryWithHistory, DiskStalls_QuestionsAreAnsweredOfWhatIsWritten) {
    start();
    announce("uno1", "online");
    ASSERT_TRUE(wait_until([&] { return rows_of("uno1") == 1; }, std::chrono::seconds(60)));
    folder_.write("stall", "");
    announce("uno2", "online");
    ASSERT_TRUE(wait_until([&] { return fs::exists(stall_ + ".met"); }, std::chrono::seconds(60)));
    EXPECT_TRUE(wait_until([&] { return rows_of("uno1") == 1; }, std::chrono::seconds(60)));
    EXPECT_EQ(rows_of("uno2"), 0u) << "it waits for the disk";
    fs::remove(stall_);
    EXPECT_TRUE(wait_until([&] { return rows_of("uno2") == 1; }, std::chrono::seconds(60)));
    stop();
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
    EXPECT_EQ(refused->refused, "history-fault");
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
