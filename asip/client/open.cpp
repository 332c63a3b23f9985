#include "asip/client/address.hpp"
#include "asip/client/board.hpp"
#include "asip/client/bus_transport.hpp"
#include "asip/client/direct_transport.hpp"

namespace asip::client {

Awaitable<Board> Board::open(boost::asio::io_context& io, std::string address, Options options) {
    auto parsed = parse_address(address);
    if (!parsed) {
        co_return failure(Error::Kind::Invalid, parsed.error());
    }
    if (!bus::Topics::legal_root(options.topic_root)) {
        co_return failure(Error::Kind::Invalid, "\"" + options.topic_root + "\" cannot be a topic root");
    }
    std::unique_ptr<Transport> transport;
    if (parsed->kind == Address::Kind::Mqtt) {
        transport = std::make_unique<BusTransport>(io, std::move(*parsed), options);
    } else {
        transport = std::make_unique<DirectTransport>(io, std::move(*parsed), options);
    }
    co_return co_await open(std::move(transport), std::move(options));
}

}  // namespace asip::client
