// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/tcp_board.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <utility>

#include "asip/time.hpp"
#include "tests/cluster/commander.hpp"

namespace cluster {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

constexpr std::string_view kServo = "S,W,0,";
constexpr auto kBetweenValues = std::chrono::milliseconds(200);
constexpr std::string_view kValue = "@D,e,1,{42}";

}  // namespace

/// Handlers of an old connection hold it, and see that it is not the board's any more.
struct TcpBoard::Connection {
    explicit Connection(tcp::socket accepted) : socket(std::move(accepted)) {}
    tcp::socket socket;
    std::array<char, 512> buffer{};
};

TcpBoard::TcpBoard(asio::io_context& io, std::string name, const std::string& address, OnExecuted on_executed)
    : on_executed_(std::move(on_executed)),
      io_(io),
      acceptor_(io),
      timer_(io),
      endpoint_(asio::ip::make_address(address), 0) {
    board_.stored_name = std::move(name);
    board_.verified_fences = true;
    plug();
}

std::vector<std::string> TcpBoard::link() const {
    return {"--tcp", fmt::format("{}:{}", endpoint_.address().to_string(), endpoint_.port())};
}

std::string TcpBoard::request(std::size_t token) const {
    return std::string(kServo) + std::to_string(token);
}

void TcpBoard::cut() {
    acceptor_.close();
    timer_.cancel();
    if (connection_) connection_->socket.close();
    connection_.reset();
}

void TcpBoard::plug() {
    acceptor_.open(endpoint_.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint_);
    acceptor_.listen();
    endpoint_ = acceptor_.local_endpoint();
    accept();
    report();
}

void TcpBoard::accept() {
    acceptor_.async_accept([this](const boost::system::error_code& error, tcp::socket socket) {
        if (error) return;
        if (connection_) connection_->socket.close();
        connection_ = std::make_shared<Connection>(std::move(socket));
        say(board_.reboot());
        read();
        accept();
    });
}

void TcpBoard::read() {
    connection_->socket.async_read_some(
        asio::buffer(connection_->buffer),
        [this, connection = connection_](const boost::system::error_code& error, std::size_t count) {
            if (error || connection != connection_) return;
            const auto said =
                board_.hear({connection->buffer.data(), count}, board_.baud, asip::Clock::now());
            executed();
            say(said);
            if (connection == connection_) read();
        });
}

void TcpBoard::executed() {
    for (const auto& line : board_.executed)
        if (line.starts_with(kServo))
            on_executed_(std::strtoull(line.c_str() + kServo.size(), nullptr, 10), now());
    board_.executed.clear();
    board_.heard.clear();
}

void TcpBoard::report() {
    timer_.expires_after(kBetweenValues);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error) return;
        if (connection_) say(board_.framed(std::string(kValue)));
        report();
    });
}

// An agent that is stopped does not read: what does not fit is lost, as on a serial line.
void TcpBoard::say(std::string_view bytes) {
    boost::system::error_code ignored;
    connection_->socket.non_blocking(true, ignored);
    connection_->socket.write_some(asio::buffer(bytes), ignored);
}

}  // namespace cluster
