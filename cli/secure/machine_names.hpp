// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace asip::cli {

/// Best first: its name, its addresses (not of loopback, links and containers), and its name in multicast
/// DNS; else `localhost`.
std::vector<std::string> machine_names();

}  // namespace asip::cli
