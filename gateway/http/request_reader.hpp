// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>

#include "gateway/http/message.hpp"

namespace asip::gateway::http {

/// Reads one request out of the bytes of a connection. Pure: bytes in, a request or an error out. Request
/// smuggling is refused rather than guessed at: a body has one Content-Length or is chunked, never both, and
/// never encoded otherwise. Fields behind a chunked body are left out.
class RequestReader {
  public:
    struct Limits {
        std::size_t header_bytes = 16 * 1024;
        std::size_t body_bytes = 64 * 1024;
    };
    /// What a broken request is answered with; the connection ends then.
    struct Error {
        int status = 400;
        std::string_view text;
    };

    explicit RequestReader(Limits limits);
    ~RequestReader();
    RequestReader(RequestReader&&) noexcept;
    RequestReader& operator=(RequestReader&&) noexcept;

    /// Takes what it can use of `bytes` and returns how much that was; give it the rest again with what
    /// follows. Not to be called once done() or error().
    std::size_t feed(std::string_view bytes);

    bool done() const;
    /// The whole head is here: time for the body begins.
    bool head_done() const;
    /// The client waits for "100 Continue" before it sends the body. True once.
    bool wants_continue();
    const std::optional<Error>& error() const;
    /// Once done(); segments and query are filled. Call once.
    Request take();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace asip::gateway::http
