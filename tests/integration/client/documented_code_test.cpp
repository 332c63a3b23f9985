// SPDX-License-Identifier: Apache-2.0
// The C++ of the documentation, as it stands there, on a real broker and a simulated board.

#include "asip/client/board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/co_spawn.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "asip/client/blocking_board.hpp"
#include "tests/integration/client/simulated_boards.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace documented {

std::string documented_address, documented_port;

int blocking_board() {
#include "documented/blocking_board.inc"
    return 0;
}

#include "documented/board.inc"

}  // namespace documented

namespace asip::test {
namespace {

TEST(DocumentedCode, BlockingBoard_MovesTheBoardAndPrintsItsDistances) {
    SimulatedBoards boards({"asip_uno_services"});
    documented::documented_port = boards.serial();
    testing::internal::CaptureStdout();
    const int status = documented::blocking_board();
    const std::string printed = testing::internal::GetCapturedStdout();
    EXPECT_EQ(status, 0);
    EXPECT_TRUE(boards.wait_for_led("on")) << boards.output();
    EXPECT_EQ(std::count(printed.begin(), printed.end(), '\n'), 5) << printed;
    EXPECT_THAT(printed, testing::StartsWith("["));
}

TEST(DocumentedCode, BlockingBoardWithoutABoard_EndsWithTheReason) {
    documented::documented_port = "/dev/asip-no-such-port";
    testing::internal::CaptureStderr();
    EXPECT_EQ(documented::blocking_board(), 1);
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                testing::StartsWith("unreachable: /dev/asip-no-such-port"));
}

TEST(DocumentedCode, Board_ButtonSwitchesTheLedUntilTheBoardIsGone) {
    const MosquittoBroker broker;
    SimulatedBoards boards({"asip_uno", "asip_uno"});
    const ChildProcess agent(
        {ASIP_TEST_AGENT, "--serial", boards.serial(0), "--name", "uno1", "--broker", broker.address()});
    documented::documented_address = broker.url() + "/uno1";
    documented::documented_port = boards.serial(1);
    boost::asio::io_context io;
    boost::asio::co_spawn(io, documented::run_switch(io), [](std::exception_ptr, const auto& ended) {
        ADD_FAILURE() << "ended: " << (ended ? "" : to_string(ended.error()));
    });
    const auto run_until_led = [&](const char* state) {
        return wait_until([&] {
            io.run_for(std::chrono::milliseconds(20));
            return boards.led_changes(state, 1) > 0;
        });
    };
    // The first level that is reported, not pressed, is written, too; only what follows a press lights the
    // LED.
    EXPECT_TRUE(wait_until([&] {
        boards.press(0);
        io.run_for(std::chrono::milliseconds(200));
        return boards.led_changes("on", 1) > 0;
    })) << boards.output();
    boards.release(0);
    EXPECT_TRUE(run_until_led("off")) << boards.output();
}

std::vector<std::string> pages() {
    std::vector<std::string> paths{ASIP_TEST_SOURCE "/README.md"};
    for (const auto& entry : std::filesystem::directory_iterator(ASIP_TEST_SOURCE "/docs"))
        if (entry.path().extension() == ".md") paths.push_back(entry.path());
    return paths;
}

/// A block of code that no test names would be one that no test compiles.
TEST(DocumentedCode, EachBlock_BelongsToAFileOrATest) {
    std::size_t blocks = 0;
    for (const std::string& path : pages()) {
        std::ifstream page(path);
        std::string before;
        for (std::string line; std::getline(page, line); before = line) {
            if (line == "```cpp") {
                ++blocks;
                EXPECT_TRUE(before.starts_with("<!-- code: ") || before.starts_with("<!-- file: "))
                    << path << ": a block of C++ behind \"" << before << "\"";
            } else if (line == "```python") {
                ++blocks;
                EXPECT_TRUE(path.ends_with("plain-mqtt.md") || path.ends_with("python.md") ||
                            path.ends_with("start-develop.md"))
                    << path << ": a block of Python that no test runs";
            }
        }
    }
    EXPECT_GT(blocks, 8u);
}

}  // namespace
}  // namespace asip::test
