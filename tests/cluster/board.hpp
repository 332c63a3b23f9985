// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "tests/unit/session/scripted_board.hpp"

namespace cluster {

/// A scripted board with a network of its own. It reports what it executed by the token in each command, and
/// sends a value five times a second.
class Board {
  public:
    using OnExecuted = std::function<void(std::size_t token)>;

    /// Accepts at `address`.
    Board(boost::asio::io_context& io, std::string name, const std::string& address, OnExecuted on_executed);
    Board(const Board&) = delete;
    Board& operator=(const Board&) = delete;

    const std::string& name() const { return board_.stored_name; }
    std::uint16_t port() const { return endpoint_.port(); }

    void cut();   ///< the connection ends, and a new one is refused
    void plug();  ///< accepts again, as a board that has just started

    /// The request that carries a token, a line of the board's servo service.
    static std::string request(std::size_t token);

  private:
    struct Connection;
    void accept();
    void read();
    void executed();
    void report();
    void say(std::string_view bytes);

    asip::session::ScriptedBoard board_;
    OnExecuted on_executed_;
    boost::asio::io_context& io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    std::shared_ptr<Connection> connection_;
    boost::asio::steady_timer timer_;
    boost::asio::ip::tcp::endpoint endpoint_;
};

}  // namespace cluster
