// SPDX-License-Identifier: Apache-2.0
#include "others.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <thread>

namespace others {
namespace {

using boost::asio::ip::tcp;

boost::asio::io_context io;
tcp::acceptor acceptor(io);
std::thread worker;

}  // namespace

std::uint16_t take_one_connection() {
    acceptor.open(tcp::v4());
    acceptor.bind({boost::asio::ip::address_v4::loopback(), 0});
    acceptor.listen();
    const auto port = acceptor.local_endpoint().port();
    worker = std::thread([] {
        boost::system::error_code error;
        tcp::socket peer(io);
        acceptor.accept(peer, error);
        peer.shutdown(tcp::socket::shutdown_both, error);
        peer.close(error);
        acceptor.close(error);
    });
    return port;
}

void wait() {
    worker.join();
}

}  // namespace others
