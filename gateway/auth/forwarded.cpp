// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/forwarded.hpp"

#include <algorithm>
#include <string_view>

#include "gateway/http/address.hpp"

namespace asip::gateway {
namespace {

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

std::string_view last_element(const http::Request& request, std::string_view name) {
    std::string_view last;
    for (const auto& [key, value] : request.headers)
        if (key == name) last = value;
    return trimmed(last.substr(last.rfind(',') + 1));
}

/// `for=192.0.2.1;proto=https` -> the value of a member, without quotes.
std::string_view member(std::string_view element, std::string_view name) {
    for (;;) {
        const auto end = std::min(element.find(';'), element.size());
        const auto pair = trimmed(element.substr(0, end));
        const auto equals = std::min(pair.find('='), pair.size());
        if (http::lower(pair.substr(0, equals)) == name && equals < pair.size()) {
            auto value = pair.substr(equals + 1);
            if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
                value = value.substr(1, value.size() - 2);
            return value;
        }
        if (end == element.size()) return {};
        element.remove_prefix(end + 1);
    }
}

/// "192.0.2.1:4711", "[2001:db8::1]:4711" or an address alone; empty: it is none.
std::string address_in(std::string_view text) {
    if (text.starts_with('['))
        text = text.substr(1, std::min(text.find(']'), text.size()) - 1);
    else if (std::count(text.begin(), text.end(), ':') == 1)
        text = text.substr(0, text.find(':'));
    return http::is_ip_address(text) ? std::string(text) : std::string();
}

}  // namespace

bool came_through_proxy(const http::Request& request) {
    return std::any_of(request.headers.begin(), request.headers.end(), [](const auto& header) {
        const std::string_view name = header.first;
        return name == "forwarded" || name.starts_with("x-forwarded-") || name == "x-real-ip" ||
               name == "via";
    });
}

Forwarded forwarded_by(const http::Request& request) {
    const auto standard = last_element(request, "forwarded");
    Forwarded result;
    result.address = address_in(last_element(request, "x-forwarded-for"));
    if (result.address.empty()) result.address = address_in(member(standard, "for"));
    auto scheme = last_element(request, "x-forwarded-proto");
    if (scheme.empty()) scheme = member(standard, "proto");
    result.secure = http::lower(scheme) == "https";
    return result;
}

}  // namespace asip::gateway
