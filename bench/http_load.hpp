// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace asip::bench {

/// A TCP connection to 127.0.0.1, without delay. Throws std::runtime_error when it is refused.
int connect_to(std::uint16_t port);

std::string http_request(std::string_view method, std::string_view target, std::string_view body = {});

/// A connection that asks and waits, again and again.
class HttpConnection {
  public:
    explicit HttpConnection(std::uint16_t port) : socket_(connect_to(port)) {}
    ~HttpConnection();
    HttpConnection(const HttpConnection&) = delete;
    HttpConnection& operator=(const HttpConnection&) = delete;

    /// The body of the answer; empty: its status was not 200. Throws where the connection ends.
    std::string ask(std::string_view request);

  private:
    int socket_;
};

struct Load {
    std::uint16_t port;
    std::string request;  ///< its answers must have a Content-Length
    int connections = 32;
    std::chrono::milliseconds time{2000};
    double per_second = 0;  ///< 0: the next one as soon as the answer is there
};
struct Answers {
    double per_second = 0;
    std::vector<double> milliseconds;  ///< from when a request was due, even where no connection was free
};
/// Keep-alive requests over several connections, by one thread that waits for nothing else.
Answers run(const Load& load);

}  // namespace asip::bench
