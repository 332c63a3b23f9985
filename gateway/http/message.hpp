// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// HTTP as the rest of the gateway sees it: no socket, no library.
namespace asip::gateway::http {

/// Behind a trusted proxy its client (Gate::peer_of()).
struct Peer {
    std::string address;    ///< without port; empty: a Unix socket
    bool loopback = false;  ///< connected directly over the loopback interface
    bool secure = false;    ///< over TLS
};

/// As it was received; only its form was checked.
struct Request {
    std::string method;                 ///< as it was written: "GET"
    std::string target;                 ///< "/api/boards?limit=10", or "*" of OPTIONS
    std::string scheme;                 ///< "http" or "https" of a target in absolute form; else empty
    std::vector<std::string> segments;  ///< of the path, percent-decoded: {"api", "boards"}
    bool folder = false;                ///< the path ends with a slash behind its segments
    std::vector<std::pair<std::string, std::string>> query;    ///< decoded, in order
    std::vector<std::pair<std::string, std::string>> headers;  ///< names in lower case
    std::string body;
    bool keep_alive = true;
    bool http_1_0 = false;
    Peer peer;

    /// The value of a header given once; empty where it is missing. `name` in lower case.
    std::string_view header(std::string_view name) const;
    bool has_header(std::string_view name) const;
    /// `OPTIONS *`: for the whole server.
    bool is_asterisk() const { return method == "OPTIONS" && target == "*"; }
    /// Its first value; null where it is missing.
    const std::string* parameter(std::string_view name) const;
};

/// Sent as a whole. The connection adds Content-Length, Connection and Content-Encoding.
struct Response {
    int status = 200;
    std::string content_type = "application/json";
    std::vector<std::pair<std::string, std::string>> headers;
    std::string body;
    /// In place of `body`, of static storage.
    std::string_view fixed;
    bool compressed = false;   ///< `fixed` or `body` is gzip already
    bool by_encoding = false;  ///< clients that take gzip get another form than those that do not
    /// Counts its bytes until the response is sent.
    std::shared_ptr<void> held{};

    std::string_view text() const { return fixed.empty() ? std::string_view(body) : fixed; }
};

std::string_view reason_phrase(int status);

/// With the empty line; without Content-Length where `chunked`.
std::string head_text(const Response& response, bool keep_alive, bool chunked);

/// Takes `target` apart into segments and query. In absolute form (RFC 9112, 3.2.2) its authority replaces
/// Host. False: no leading slash, a broken percent escape, control characters, an empty (but for the last),
/// `.` or `..` segment, or a decoded slash.
bool split_target(Request& request);

/// `%41+b` -> `A b` where `plus` is a blank; false: broken.
bool percent_decode(std::string_view text, bool plus, std::string& decoded);

/// By Accept-Encoding; gzip counts before `*`.
bool accepts_gzip(const Request& request);

/// As gzip, quickly rather than small.
std::string compress(std::string_view text);
std::string decompress(std::string_view gzip);

/// ASCII only.
std::string lower(std::string_view text);

/// As RFC 6455 has it.
bool is_upgrade(const Request& request);

}  // namespace asip::gateway::http
