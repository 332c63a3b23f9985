// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/message.hpp"

#include <zlib.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

namespace asip::gateway::http {

namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

bool showable(std::string_view text) {
    return std::none_of(text.begin(), text.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte < 0x20 || byte == 0x7f;
    });
}

bool add_segment(Request& request, std::string_view raw) {
    std::string segment;
    if (!percent_decode(raw, false, segment) || !showable(segment)) return false;
    if (segment.empty() || segment == "." || segment == "..") return false;
    if (segment.find('/') != std::string::npos || segment.find('\\') != std::string::npos) return false;
    request.segments.push_back(std::move(segment));
    return true;
}

bool add_parameter(Request& request, std::string_view pair) {
    if (pair.empty()) return true;
    const auto equals = pair.find('=');
    std::string name, value;
    if (!percent_decode(pair.substr(0, equals), true, name)) return false;
    if (equals != std::string_view::npos && !percent_decode(pair.substr(equals + 1), true, value))
        return false;
    if (!showable(name) || !showable(value)) return false;
    request.query.emplace_back(std::move(name), std::move(value));
    return true;
}

std::string_view next_part(std::string_view& rest, char separator) {
    const auto at = rest.find(separator);
    const auto part = rest.substr(0, at);
    rest = at == std::string_view::npos ? std::string_view() : rest.substr(at + 1);
    return part;
}

// "http://host:8080/api" -> scheme, Host and "/api". False: its authority is none of HTTP's.
bool take_absolute(Request& request) {
    const std::string_view target = request.target;
    const auto colon = target.find("://");
    if (colon == std::string_view::npos) return true;
    const auto scheme = lower(target.substr(0, colon));
    if (scheme != "http" && scheme != "https") return true;
    const auto behind = target.substr(colon + 3);
    const auto end = std::min(behind.size(), behind.find_first_of("/?"));
    const auto authority = behind.substr(0, end);
    if (authority.empty() || authority.find_first_of("@#\\") != std::string_view::npos) return false;
    for (auto& [name, value] : request.headers)
        if (name == "host") value = authority;
    if (request.http_1_0 && !request.has_header("host")) request.headers.emplace_back("host", authority);
    request.scheme = scheme;
    auto path = std::string(behind.substr(end));
    if (path.empty() && request.method == "OPTIONS") path = "*";
    if (path != "*" && !path.starts_with('/')) path.insert(0, 1, '/');
    request.target = std::move(path);
    return true;
}

constexpr int kGzip = 16 + MAX_WBITS;

template <class Step>
std::string run(z_stream& stream, std::string_view input, Step step) {
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(input.data()));
    stream.avail_in = static_cast<uInt>(input.size());
    std::string output;
    std::array<char, 16384> piece;
    for (int result = Z_OK; result == Z_OK;) {
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = piece.size();
        result = step();
        output.append(piece.data(), piece.size() - stream.avail_out);
    }
    return output;
}

}  // namespace

std::string_view Request::header(std::string_view name) const {
    for (const auto& [key, value] : headers)
        if (key == name) return value;
    return {};
}

bool Request::has_header(std::string_view name) const {
    return std::any_of(headers.begin(), headers.end(), [&](const auto& each) { return each.first == name; });
}

const std::string* Request::parameter(std::string_view name) const {
    for (const auto& [key, value] : query)
        if (key == name) return &value;
    return nullptr;
}

bool percent_decode(std::string_view text, bool plus, std::string& decoded) {
    decoded.clear();
    for (;;) {
        const auto at = std::min(text.size(), plus ? text.find_first_of("%+") : text.find('%'));
        decoded.append(text.substr(0, at));
        text.remove_prefix(at);
        if (text.empty()) return true;
        if (text.front() == '+') {
            decoded += ' ';
            text.remove_prefix(1);
            continue;
        }
        if (text.size() < 3) return false;
        const int high = hex_digit(text[1]);
        const int low = hex_digit(text[2]);
        if (high < 0 || low < 0) return false;
        decoded += static_cast<char>(high * 16 + low);
        text.remove_prefix(3);
    }
}

bool split_target(Request& request) {
    request.segments.clear();
    request.segments.reserve(8);  // as the longest path of the API
    request.folder = false;
    request.query.clear();
    if (!take_absolute(request)) return false;
    const std::string_view rest = request.target;
    if (request.is_asterisk()) return true;
    if (rest.empty() || rest.front() != '/') return false;
    const auto question = rest.find('?');
    std::string_view path = rest.substr(1, question == std::string_view::npos ? question : question - 1);
    std::string_view query = question == std::string_view::npos ? "" : rest.substr(question + 1);
    while (!path.empty()) {
        const bool last = path.find('/') == std::string_view::npos;
        // Two slashes are one: addresses are put together of parts that end and begin with one.
        const auto part = next_part(path, '/');
        if (!part.empty() && !add_segment(request, part)) return false;
        request.folder = !last && path.empty();
    }
    while (!query.empty())
        if (!add_parameter(request, next_part(query, '&'))) return false;
    return true;
}

bool accepts_gzip(const Request& request) {
    bool any = false;
    std::string_view rest = request.header("accept-encoding");
    while (!rest.empty()) {
        std::string_view trimmed = next_part(rest, ',');
        trimmed.remove_prefix(std::min(trimmed.size(), trimmed.find_first_not_of(" \t")));
        const auto coding = lower(trimmed);
        const auto name = coding.substr(0, coding.find_first_of("; \t"));
        if (name != "gzip" && name != "*") continue;
        const auto zero = coding.find("q=0");
        const bool taken =
            zero == std::string::npos || coding.find_first_of("123456789", zero + 3) != std::string::npos;
        if (name == "gzip") return taken;
        any = taken;
    }
    return any;
}

std::string_view reason_phrase(int status) {
    constexpr std::pair<int, std::string_view> kReasons[] = {{101, "Switching Protocols"},
                                                             {200, "OK"},
                                                             {201, "Created"},
                                                             {202, "Accepted"},
                                                             {207, "Multi-Status"},
                                                             {204, "No Content"},
                                                             {303, "See Other"},
                                                             {304, "Not Modified"},
                                                             {307, "Temporary Redirect"},
                                                             {308, "Permanent Redirect"},
                                                             {400, "Bad Request"},
                                                             {401, "Unauthorized"},
                                                             {403, "Forbidden"},
                                                             {404, "Not Found"},
                                                             {405, "Method Not Allowed"},
                                                             {406, "Not Acceptable"},
                                                             {408, "Request Timeout"},
                                                             {409, "Conflict"},
                                                             {411, "Length Required"},
                                                             {412, "Precondition Failed"},
                                                             {413, "Content Too Large"},
                                                             {414, "URI Too Long"},
                                                             {415, "Unsupported Media Type"},
                                                             {421, "Misdirected Request"},
                                                             {422, "Unprocessable Content"},
                                                             {426, "Upgrade Required"},
                                                             {428, "Precondition Required"},
                                                             {429, "Too Many Requests"},
                                                             {431, "Request Header Fields Too Large"},
                                                             {500, "Internal Server Error"},
                                                             {501, "Not Implemented"},
                                                             {502, "Bad Gateway"},
                                                             {503, "Service Unavailable"},
                                                             {504, "Gateway Timeout"},
                                                             {505, "HTTP Version Not Supported"}};
    for (const auto& [each, phrase] : kReasons)
        if (each == status) return phrase;
    return "Unknown";
}

std::string head_text(const Response& response, bool keep_alive, bool chunked) {
    std::string text;
    text.reserve(512);
    text.append("HTTP/1.1 ").append(std::to_string(response.status)).append(" ");
    text.append(reason_phrase(response.status)).append("\r\n");
    const bool bodiless = response.status == 204 || response.status == 304 || response.status == 101;
    if (!bodiless) text.append("Content-Type: ").append(response.content_type).append("\r\n");
    if (response.compressed) text.append("Content-Encoding: gzip\r\n");
    if (response.by_encoding) text.append("Vary: Accept-Encoding\r\n");
    for (const auto& [name, value] : response.headers)
        text.append(name).append(": ").append(value).append("\r\n");
    if (chunked)
        text.append("Transfer-Encoding: chunked\r\n");
    else if (!bodiless)
        text.append("Content-Length: ").append(std::to_string(response.text().size())).append("\r\n");
    if (response.status != 101) text.append(keep_alive ? "" : "Connection: close\r\n");
    return text.append("\r\n");
}

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
}

bool is_upgrade(const Request& request) {
    return request.method == "GET" && lower(request.header("upgrade")) == "websocket" &&
           lower(request.header("connection")).find("upgrade") != std::string::npos &&
           request.header("sec-websocket-version") == "13" && !request.header("sec-websocket-key").empty();
}

std::string compress(std::string_view text) {
    z_stream stream{};
    if (deflateInit2(&stream, 1, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::runtime_error("zlib");
    auto output = run(stream, text, [&] { return deflate(&stream, Z_FINISH); });
    deflateEnd(&stream);
    return output;
}

std::string decompress(std::string_view gzip) {
    z_stream stream{};
    if (inflateInit2(&stream, kGzip) != Z_OK) throw std::runtime_error("zlib");
    auto output = run(stream, gzip, [&] { return inflate(&stream, Z_NO_FLUSH); });
    inflateEnd(&stream);
    return output;
}

}  // namespace asip::gateway::http
