// SPDX-License-Identifier: Apache-2.0
#pragma once
#ifdef BOOST_ASIO_NO_DEPRECATED
#error \
    "BOOST_ASIO_NO_DEPRECATED changes what functions of Asio return, and the ASIP library is compiled without it"
#endif
#include <utility>  // Boost 1.74's awaitable.hpp uses std::exchange without it

#include <boost/asio/awaitable.hpp>

#include "asip/client/error.hpp"

namespace asip::client {

/// What a call returns to a coroutine: a value or an Error. Nothing that happens to a board throws.
/// `const auto done = co_await board.digital_write(13, true);`
template <class T>
using Awaitable = boost::asio::awaitable<Result<T>>;

}  // namespace asip::client
