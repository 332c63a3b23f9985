// SPDX-License-Identifier: Apache-2.0
#include "asip/client/address.hpp"
#include "asip/client/board.hpp"
#include "asip/client/bus_transport.hpp"
#include "asip/client/direct_transport.hpp"

namespace asip::client {

// No coroutines but fail_to_open: g++ 12 copies a caller's temporaries bit by bit where an aggregate, such as
// a defaulted Options, is an argument in a co_await expression, and then destroys them twice.

Awaitable<Board> Board::fail_to_open(Error error) {
    co_return Unexpected<Error>(std::move(error));
}

Awaitable<Board> Board::open(boost::asio::io_context& io, std::string_view address) {
    return open(io, address, Options());
}

Awaitable<Board> Board::open(boost::asio::io_context& io, std::string_view address, const Options& options) {
    auto parsed = parse_address(address);
    if (!parsed) return fail_to_open({Error::Kind::kInvalid, 0, parsed.error()});
    if (!bus::Topics::valid_root(options.topic_root)) {
        return fail_to_open(
            {Error::Kind::kInvalid, 0, "\"" + options.topic_root + "\" cannot be a topic root"});
    }
    std::unique_ptr<Transport> transport;
    if (parsed->kind == Address::Kind::kMqtt)
        transport = std::make_unique<BusTransport>(io, std::move(*parsed), options);
    else
        transport = std::make_unique<DirectTransport>(io, std::move(*parsed), options);
    return open(std::move(transport), options);
}

}  // namespace asip::client
