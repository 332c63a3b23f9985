// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace asip::cli {

/// By what other machines may call this one, best first: its name, its addresses (not those of loopback,
/// links and containers), and its name in multicast DNS. Without a network: `localhost`.
std::vector<std::string> machine_names();

}  // namespace asip::cli
