// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>

#include "gateway/http/message.hpp"

namespace asip::gateway::http {

/// Reads one request. Pure. Smuggling is refused: a body has one Content-Length or is chunked, never both,
/// and never encoded otherwise. Fields behind a chunked body are left out.
class RequestReader {
  public:
    struct Limits {
        std::size_t header_bytes = 16 * 1024;
        std::size_t body_bytes = 64 * 1024;
    };
    /// Answered, and the connection ends.
    struct Error {
        int status = 400;
        std::string_view text;
    };

    explicit RequestReader(Limits limits);
    ~RequestReader();
    RequestReader(RequestReader&&) noexcept;
    RequestReader& operator=(RequestReader&&) noexcept;

    /// Returns how much of `bytes` it took; the rest comes again. Not behind done() or error().
    std::size_t feed(std::string_view bytes);

    bool done() const;
    /// Time for the body begins.
    bool head_done() const;
    /// The client waits for "100 Continue". True once.
    bool wants_continue();
    const std::optional<Error>& error() const;
    /// Once done(); with segments and query. Call once.
    Request take();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace asip::gateway::http
