// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/secrets.hpp"

#include <openssl/evp.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace asip::cli {
namespace {

constexpr int kRounds = 1;

std::string base64(std::string_view bytes) {
    std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');
    const int length =
        EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                        reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
    text.resize(static_cast<std::size_t>(length));
    return text;
}

}  // namespace

std::string random_bytes(std::size_t count) {
    std::string bytes(count, '\0');
    if (RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), static_cast<int>(count)) != 1)
        throw std::runtime_error("the operating system gives no random bytes");
    return bytes;
}

std::string random_password() {
    auto text = base64(random_bytes(32));
    std::replace(text.begin(), text.end(), '+', '-');
    std::replace(text.begin(), text.end(), '/', '_');
    text.erase(text.find_last_not_of('=') + 1);
    return text;
}

std::string mosquitto_hash(std::string_view password, std::string_view salt) {
    std::array<unsigned char, 64> hash{};
    if (PKCS5_PBKDF2_HMAC(password.data(), static_cast<int>(password.size()),
                          reinterpret_cast<const unsigned char*>(salt.data()), static_cast<int>(salt.size()),
                          kRounds, EVP_sha512(), static_cast<int>(hash.size()), hash.data()) != 1)
        throw std::runtime_error("PBKDF2 with SHA-512 is not available");
    const std::string_view bytes(reinterpret_cast<const char*>(hash.data()), hash.size());
    return "$7$" + std::to_string(kRounds) + "$" + base64(salt) + "$" + base64(bytes);
}

}  // namespace asip::cli
