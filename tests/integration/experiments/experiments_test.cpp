// SPDX-License-Identifier: Apache-2.0
// A small part of each of the papers' experiments, so that they still work when a reader needs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string text_of(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

/// Rows of a CSV file without quoted cells, its header first.
std::vector<std::vector<std::string>> table(const std::string& path) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(text_of(path));
    for (std::string line; std::getline(lines, line);) {
        auto& row = rows.emplace_back();
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');)
            row.push_back(cell);
    }
    return rows;
}

class Experiments : public ::testing::Test {
  protected:
    Finished run_quick(std::vector<std::string> words) {
        words.insert(words.begin(), {ASIP_EXPERIMENTS, "--quick", "--out", folder_.path().string()});
        return run(words, {}, time_limit(20s));
    }
    void expect_picture(const std::string& name) {
        const auto text = text_of(folder_.file(name));
        EXPECT_THAT(text, StartsWith("<svg ")) << name;
        EXPECT_THAT(text, EndsWith("</svg>\n")) << name;
        EXPECT_EQ(text.find("nan"), std::string::npos) << name;
    }
    /// The first row whose cells begin so.
    std::vector<std::string> row(const std::string& file, const std::vector<std::string>& begin) {
        for (auto& row : table(folder_.file(file)))
            if (row.size() >= begin.size() && std::equal(begin.begin(), begin.end(), row.begin())) return row;
        ADD_FAILURE() << file << " has no row " << begin[0] << ":\n" << text_of(folder_.file(file));
        return std::vector<std::string>(8, "0");
    }

    TempDir folder_;
};

TEST_F(Experiments, OfBoardsAndBus_LeaveTablesAndPlots) {
    const auto done = run_quick({"latency", "throughput", "switch", "discovery"});
    ASSERT_EQ(done.status, 0) << done.output << done.errors;
    // What the wire alone takes is 3.06 ms.
    for (const char* link : {"serial", "TCP", "MQTT"})
        EXPECT_GT(std::stod(row("latency.csv", {link, "57600"})[4]), 3.0) << link;
    // How many Hz this machine keeps up with is a figure, not a test.
    for (const char* link : {"serial", "MQTT"})
        EXPECT_GE(std::stod(row("throughput.csv", {link, "57600"})[3]), 0) << done.output;
    EXPECT_GT(std::stod(row("switch.csv", {"MQTT"})[2]), 0.3);
    // Names are asked for 1.3 s before they are taken.
    EXPECT_GT(std::stod(row("discovery.csv", {"all see a board that joins three others late"})[1]), 1300);
    for (const char* name : {"latency.svg", "throughput.svg", "switch.svg", "discovery.svg"})
        expect_picture(name);
}

TEST_F(Experiments, OfMemoryAndRobot_LeaveTablesAndPlots) {
    const auto done = run_quick({"footprint", "pid"});
    ASSERT_EQ(done.status, 0) << done.output << done.errors;
    EXPECT_THAT(text_of(folder_.file("footprint.csv")), HasSubstr("AsipMirto"));
    EXPECT_NEAR(std::stod(row("pid-period.csv", {"50", "mqtt"})[2]), 16, 1);
    EXPECT_EQ(row("pid-latency.csv", {"100", "50 ms"})[2], "leaves the line");
    for (const char* name : {"footprint-ram.svg", "footprint-flash.svg", "pid-period.svg", "pid-latency.svg"})
        expect_picture(name);
}

TEST_F(Experiments, OtherImage_IsMeasuredBesideOurs) {
    const auto done = run_quick({"footprint", "switch", "--with-image", ASIP_IMAGES "/asip_uno_04.elf"});
    ASSERT_EQ(done.status, 0) << done.output << done.errors;
    EXPECT_GT(std::stod(row("switch.csv", {"MQTT", "asip_uno_04"})[2]), 3.0);
}

TEST_F(Experiments, WhatCannotBeMeasured_IsSaidInOneLine) {
    const auto none = run_quick({"lateny"});
    EXPECT_EQ(none.status, 2);
    EXPECT_THAT(none.errors, HasSubstr("there is no experiment \"lateny\""));
    const auto text = run_quick({"footprint", "--with-image", ASIP_SOURCE_DIR "/README.md"});
    EXPECT_EQ(text.status, 1);
    EXPECT_THAT(text.errors, HasSubstr("give an .elf file"));
}

}  // namespace
}  // namespace asip::test
