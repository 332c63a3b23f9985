// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "gateway/cable/cable_way.hpp"

namespace boost::asio {
class io_context;
}

namespace asip::gateway {

/// A connection to `asip-agent --cables FOLDER`. No handler is called within this call.
std::unique_ptr<CableWay> agent_way(boost::asio::io_context& io, const std::string& folder,
                                    CableWay::Handlers handlers);

}  // namespace asip::gateway
