// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace asip::cli {

/// From the operating system. Throws std::runtime_error when it gives none.
std::string random_bytes(std::size_t count);

/// 256 random bits in 43 characters without quoting.
std::string random_password();

/// For Mosquitto's password file: PBKDF2 with SHA-512, `$7$1$SALT$HASH`. One round suffices for random
/// passwords, and the broker checks all clients again at a reload (1,000 clients: 0.1 s with 101 rounds).
std::string mosquitto_hash(std::string_view password, std::string_view salt);

}  // namespace asip::cli
