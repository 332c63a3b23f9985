// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tests/cluster/board.hpp"
#include "tests/unit/session/scripted_board.hpp"

namespace cluster {

/// A scripted board with a network of its own, which sends a value five times a second.
class TcpBoard : public Board {
  public:
    /// Accepts at `address`.
    TcpBoard(boost::asio::io_context& io, std::string name, const std::string& address,
             OnExecuted on_executed);

    std::vector<std::string> link() const override;
    /// A line of the board's servo service.
    std::string request(std::size_t token) const override;
    void cut() override;
    void plug() override;

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
