// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/secret.hpp"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/rand.h>

#include <stdexcept>

namespace asip::gateway {

std::string random_secret(std::size_t bytes) {
    std::string raw(bytes, '\0');
    if (RAND_bytes(reinterpret_cast<unsigned char*>(raw.data()), static_cast<int>(bytes)) != 1)
        throw std::runtime_error("the operating system gives no random bytes");
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    std::string text;
    unsigned value = 0;
    int bits = 0;
    for (const char c : raw) {
        value = (value << 8 | static_cast<unsigned char>(c)) & 0xffffff;
        bits += 8;
        for (; bits >= 6; bits -= 6)
            text += kDigits[value >> (bits - 6) & 63];
    }
    if (bits > 0) text += kDigits[value << (6 - bits) & 63];
    return text;
}

std::string hash_of(std::string_view secret) {
    // Fetched once: that costs more than the hash of a short text.
    static const EVP_MD* const algorithm = EVP_MD_fetch(nullptr, "SHA256", nullptr);
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned length = 0;
    EVP_Digest(secret.data(), secret.size(), digest, &length, algorithm, nullptr);
    std::string text;
    for (unsigned i = 0; i < length; ++i) {
        text += "0123456789abcdef"[digest[i] >> 4];
        text += "0123456789abcdef"[digest[i] & 15];
    }
    return text;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
    return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace asip::gateway
