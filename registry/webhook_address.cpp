// SPDX-License-Identifier: Apache-2.0
#include "registry/webhook_address.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <charconv>

namespace asip::registry {

std::optional<std::string> percent_decoded(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            result += text[i];
            continue;
        }
        unsigned byte = 0;
        const auto digits = text.substr(i + 1, 2);
        const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
        if (digits.size() != 2 || fault != std::errc{} || end != digits.data() + 2) return std::nullopt;
        result += static_cast<char>(byte);
        i += 2;
    }
    return result;
}

std::string basic(const std::string& user) {
    std::string text(4 * ((user.size() + 2) / 3) + 1, '\0');
    text.resize(static_cast<std::size_t>(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                                         reinterpret_cast<const unsigned char*>(user.data()),
                                                         static_cast<int>(user.size()))));
    return text;
}

Expected<WebhookAddress> parse_webhook(const std::string& given) {
    std::string url = given, user;
    const auto scheme = url.find("://");
    auto path = scheme == std::string::npos ? scheme : url.find_first_of("/?#", scheme + 3);
    const auto at = scheme == std::string::npos ? scheme : url.substr(0, path).rfind('@');
    if (at != std::string::npos) {
        const auto name = percent_decoded(std::string_view(url).substr(scheme + 3, at - scheme - 3));
        if (!name || name->find(':') == std::string::npos)
            return fail("before the host NAME:PASSWORD@ is expected; other characters are written as %XX");
        user = *name;
        url.erase(scheme + 3, at - scheme - 2);
        path = url.find_first_of("/?#", scheme + 3);
    }
    auto address = text::parse_http_address(url.substr(0, path));
    if (!address) return fail(address.error());
    auto target = path == std::string::npos ? std::string("/") : url.substr(path);
    if (target.front() != '/') target.insert(0, "/");
    target.resize(std::min(target.size(), target.find('#')));
    if (std::any_of(target.begin(), target.end(),
                    [](unsigned char byte) { return byte <= ' ' || byte >= 127; }))
        return fail("the path of the address has a character that must be written as %XX");
    return WebhookAddress{std::move(*address), std::move(target), std::move(user)};
}

}  // namespace asip::registry
