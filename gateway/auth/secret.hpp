// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <string_view>

namespace asip::gateway {

/// Where secrets come from: each call returns that many random bytes as unpadded base64url text. Passed in,
/// so that tests can say what is drawn.
using Secrets = std::function<std::string(std::size_t bytes)>;

/// From the operating system's cryptographic generator. Throws std::runtime_error when it fails.
std::string random_secret(std::size_t bytes);

/// SHA-256 as 64 hexadecimal digits. Enough for secrets of 256 random bits, which no attacker can guess.
std::string hash_of(std::string_view secret);

/// Takes as long for equal texts as for any others of one length.
bool equal_in_constant_time(std::string_view a, std::string_view b);

}  // namespace asip::gateway
