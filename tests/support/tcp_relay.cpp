// SPDX-License-Identifier: Apache-2.0
#include "tests/support/tcp_relay.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <functional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace asip::test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

}  // namespace

class TcpRelay::State {
  public:
    State(std::uint16_t to, Swallows swallows)
        : to_(asio::ip::address_v4::loopback(), to), swallows_(std::move(swallows)) {
        accept();
        thread_ = std::thread([this] { io_.run(); });
    }
    ~State() {
        io_.stop();
        thread_.join();
    }

    std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
    void cut() {
        asio::post(io_, [this] { cut_ = true; });
    }
    void cut(Swallows which) {
        asio::post(io_, [this, which = std::move(which)] {
            is_cut_ = which;
            for (const auto& [client, first] : begun_)
                if (which(first)) stuck_.insert(client);
        });
    }
    void restore() {
        asio::post(io_, [this] {
            cut_ = false;
            is_cut_ = nullptr;
            stuck_.clear();
            for (const auto& pass : std::exchange(waiting_, {}))
                pass();
        });
    }

  private:
    using Socket = std::shared_ptr<tcp::socket>;

    void accept() {
        acceptor_.async_accept([this](const boost::system::error_code& error, tcp::socket socket) {
            if (error) return;
            const auto from = std::make_shared<tcp::socket>(std::move(socket));
            const auto to = std::make_shared<tcp::socket>(io_);
            boost::system::error_code refused;
            to->connect(to_, refused);
            if (!refused) carry(from, to, true), carry(to, from);
            accept();
        });
    }

    void note(const Socket& client, const std::string& first) {
        begun_.emplace_back(client, first);
        if (is_cut_ && is_cut_(first)) stuck_.insert(client);
    }

    void carry(const Socket& from, const Socket& to, bool first = false) {
        auto bytes = std::make_shared<std::string>(65536, '\0');
        from->async_read_some(asio::buffer(*bytes),
                              [=, this](const boost::system::error_code& error, std::size_t count) {
                                  if (first && !error) note(from, bytes->substr(0, count));
                                  if (first && !error && swallows_ && swallows_({bytes->data(), count}))
                                      return void(swallowed_.insert(swallowed_.end(), {from, to}));
                                  const auto pass = [=, this] {
                                      boost::system::error_code failed = error;
                                      if (!failed) asio::write(*to, asio::buffer(*bytes, count), failed);
                                      if (!failed) return carry(from, to);
                                      to->close(failed);
                                      from->close(failed);
                                  };
                                  if (cut_ || stuck_.count(to) + stuck_.count(from) != 0)
                                      waiting_.emplace_back(pass);
                                  else
                                      pass();
                              });
    }

    asio::io_context io_;
    const tcp::endpoint to_;
    tcp::acceptor acceptor_{io_, {asio::ip::address_v4::loopback(), 0}};
    const Swallows swallows_;
    std::vector<Socket> swallowed_;
    std::vector<std::pair<Socket, std::string>> begun_;  // each client with the first that it sent
    Swallows is_cut_;
    std::set<Socket> stuck_;
    bool cut_ = false;
    std::vector<std::function<void()>> waiting_;
    std::thread thread_;
};

TcpRelay::TcpRelay(std::uint16_t to, Swallows swallows)
    : state_(std::make_unique<State>(to, std::move(swallows))) {}
TcpRelay::~TcpRelay() = default;
std::uint16_t TcpRelay::port() const {
    return state_->port();
}
void TcpRelay::cut() {
    state_->cut();
}
void TcpRelay::cut(Swallows which) {
    state_->cut(std::move(which));
}
void TcpRelay::restore() {
    state_->restore();
}

}  // namespace asip::test
