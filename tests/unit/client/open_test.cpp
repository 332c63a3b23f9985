// SPDX-License-Identifier: Apache-2.0
#include "asip/client/board.hpp"

#include <gtest/gtest.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <vector>

namespace asip::client {
namespace {

// Longer than what std::string keeps inside itself.
constexpr const char* kNoPort = "/dev/asip-no-such-port-of-any-machine";

boost::asio::awaitable<void> open_in_every_way(boost::asio::io_context& io,
                                               std::vector<std::string>& errors) {
    const auto by_default = co_await Board::open(io, kNoPort);
    errors.push_back(to_string(by_default.error()));
    const auto braces = co_await Board::open(io, std::string(kNoPort), {});
    errors.push_back(to_string(braces.error()));
    Options options;
    options.topic_root = "a topic root that is longer than the string itself";
    const auto named = co_await Board::open(io, kNoPort, options);
    errors.push_back(to_string(named.error()));
}

TEST(BoardOpenTest, FromACoroutineWithOptionsLeftOut_FailsWithItsReasonAndFreesNothingTwice) {
    boost::asio::io_context io;
    std::vector<std::string> errors;
    boost::asio::co_spawn(io, open_in_every_way(io, errors), boost::asio::detached);
    io.run();
    ASSERT_EQ(errors.size(), 3u);
    for (const std::string& error : errors)
        EXPECT_NE(error.find(kNoPort), std::string::npos) << error;
}

TEST(BoardOpenTest, AddressOrTopicRootThatCannotBe_IsInvalidWithTheReason) {
    boost::asio::io_context io;
    std::vector<Error> errors;
    const auto open = [&]() -> boost::asio::awaitable<void> {
        const auto address = co_await Board::open(io, "tcp://no-port");
        errors.push_back(address.error());
        Options options;
        options.topic_root = "#";
        const auto root = co_await Board::open(io, "uno1", options);
        errors.push_back(root.error());
    };
    boost::asio::co_spawn(io, open, boost::asio::detached);
    io.run();
    ASSERT_EQ(errors.size(), 2u);
    EXPECT_EQ(errors[0].kind, Error::Kind::kInvalid);
    EXPECT_EQ(errors[1].kind, Error::Kind::kInvalid);
    EXPECT_NE(errors[1].text.find("\"#\""), std::string::npos) << errors[1].text;
}

}  // namespace
}  // namespace asip::client
