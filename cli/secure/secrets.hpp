// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace asip::cli {

/// Bytes of the operating system's cryptographic generator. Throws std::runtime_error when it gives none.
std::string random_bytes(std::size_t count);

/// A password of 256 random bits, in 43 characters that need no quoting.
std::string random_password();

/// What Mosquitto's password file holds behind the user's name: PBKDF2 with SHA-512, as `$7$1$SALT$HASH`. One
/// round: passwords are random, so that there is nothing to guess, and at a reload the broker checks those of
/// all connected clients again before it does anything else (1,000 clients: 0.1 s with the 101 rounds of
/// mosquitto_passwd).
std::string mosquitto_hash(std::string_view password, std::string_view salt);

}  // namespace asip::cli
