// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/turn_executor.hpp"

#include <gmock/gmock.h>

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/connect_pair.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

namespace asip::gateway::http {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Socket = asio::local::stream_protocol::socket;

// A handshake is such an operation: each of its parts reads, and computes.
TEST(TurnExecutor, OperationOfSeveralParts_EachPartIsAJobOfItsName) {
    asio::io_context io;
    Duration used{};
    int jobs = 0;
    bus::Shares shares([&] { return used += 1ms; }, [&] { ++jobs; });
    Socket here(io), there(io);
    asio::local::connect_pair(here, there);
    char bytes[2];
    bool done = false;
    asio::async_read(here, asio::buffer(bytes),
                     asio::bind_executor(TurnExecutor(io, shares, "address 10.0.0.1"),
                                         [&](const boost::system::error_code& error, std::size_t) {
                                             EXPECT_FALSE(error);
                                             done = true;
                                         }));
    for (int part = 1; part <= 2; ++part) {
        asio::write(there, asio::buffer("x", 1));
        io.restart();
        io.run_for(5s);
        EXPECT_EQ(jobs, part);
        EXPECT_FALSE(done) << "it waits for its turn";
        EXPECT_EQ(shares.names(), 1u);
        while (shares.run()) {
        }
    }
    EXPECT_TRUE(done);
    EXPECT_GT(used, 0ms);
}

}  // namespace
}  // namespace asip::gateway::http
