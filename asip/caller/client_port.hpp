// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/caller/caller.hpp"

namespace asip::caller {

/// A caller acts through this connection, which must outlive what the caller does; `changed` is left empty.
Caller::Port port_of(mqtt::Client& client);

}  // namespace asip::caller
