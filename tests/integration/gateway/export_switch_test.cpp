// SPDX-License-Identifier: Apache-2.0
// `asip-gateway export`: what it makes of the file that a service manager reads, and what a gateway makes of
// that.
#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <sstream>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class ExportSwitch : public testing::Test {
  protected:
    auto change(std::vector<std::string> words) {
        words.insert(words.begin(), {ASIP_PROGRAMS "/asip-gateway", "export"});
        words.insert(words.end(), {"--env", file_});
        return run(words);
    }
    std::string text() const {
        std::ifstream in(file_);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    TempDir folder_;
    std::string file_ = folder_.file("gateway.env");
};

TEST_F(ExportSwitch, On_IsOneLineHoweverOften_AndOffTakesItOut) {
    std::ofstream(file_) << "# mine\nASIP_HTTP=0.0.0.0:8080";
    for (int i = 0; i < 2; ++i) {
        const auto on = change({"home-assistant"});
        ASSERT_EQ(on.status, 0) << on.errors;
        EXPECT_THAT(on.output, HasSubstr("from its next start on"));
        EXPECT_EQ(text(), "# mine\nASIP_HTTP=0.0.0.0:8080\nASIP_HOME_ASSISTANT=homeassistant\n");
    }
    EXPECT_EQ(change({"home-assistant", "ha"}).status, 0);
    EXPECT_EQ(change({"homie"}).status, 0);
    EXPECT_EQ(change({"sparkplug", "plant/hall-2"}).status, 0);
    EXPECT_EQ(text(),
              "# mine\nASIP_HTTP=0.0.0.0:8080\nASIP_HOME_ASSISTANT=ha\nASIP_HOMIE=homie\n"
              "ASIP_SPARKPLUG=plant/hall-2\n");
    for (const char* system : {"home-assistant", "homie", "sparkplug"})
        EXPECT_EQ(change({system, "--off"}).status, 0) << system;
    EXPECT_EQ(text(), "# mine\nASIP_HTTP=0.0.0.0:8080\n");
}

TEST_F(ExportSwitch, FileThatIsNotThere_IsMade) {
    ASSERT_EQ(change({"homie"}).status, 0);
    EXPECT_EQ(text(), "ASIP_HOMIE=homie\n");
}

TEST_F(ExportSwitch, LinesOfTheFile_AreWhatAGatewayStartsWith) {
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"home-assistant"}, {"homie"}, {"sparkplug", "plant"}})
        ASSERT_EQ(change(words).status, 0);
    std::map<std::string, std::string> environment;
    std::istringstream lines(text());
    for (std::string line; std::getline(lines, line);)
        environment[line.substr(0, line.find('='))] = line.substr(line.find('=') + 1);
    MosquittoBroker broker;
    ChildProcess gateway(
        {ASIP_PROGRAMS "/asip-gateway", "--http", "127.0.0.1:0", "--broker", broker.address()}, environment);
    for (const char* system : {"Home Assistant", "Homie", "Sparkplug as plant/asip"})
        EXPECT_TRUE(gateway.wait_for_errors(std::string("exports boards to ") + system)) << system;
}

TEST_F(ExportSwitch, WhatAGatewayWouldNotStartWith_IsRefusedAndTheFileStays) {
    std::ofstream(file_) << "ASIP_HOMIE=homie\n";
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"sparkplug"},
                                               {"homie", "No Domain"},
                                               {"homie", "UPPER"},
                                               {"home-assistant", "a#b"},
                                               {"matter"}}) {
        const auto refused = change(words);
        EXPECT_NE(refused.status, 0) << words.back();
        EXPECT_FALSE(refused.errors.empty());
        EXPECT_EQ(text(), "ASIP_HOMIE=homie\n") << words.back();
    }
    EXPECT_EQ(change({"home-assistant"}).status, 0);
    EXPECT_EQ(text(), "ASIP_HOMIE=homie\nASIP_HOME_ASSISTANT=homeassistant\n");
}

}  // namespace
}  // namespace asip::test
