// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "asip/time.hpp"
#include "registry/webhook_address.hpp"

namespace asip::registry {

enum class WebhookResult {
    kDelivered,
    kFailed,   ///< it may be taken later
    kRefused,  ///< it will not be taken: a status of the 400s, or another address (300s)
};

/// The answer of a receiver, in pieces of any size. Lines may end with a lone newline, and statuses of the
/// 100s may come first.
class WebhookAnswer {
  public:
    static constexpr std::size_t kMaxBytes = 16 * 1024;  // what is behind them does not count
    static constexpr std::size_t kMaxWords = 200;        // of its body, in the log
    static constexpr Duration kMaxWait = std::chrono::hours(1);

    struct Verdict {
        WebhookResult result;
        std::string why;  ///< with the receiver's words, and nothing of `asked` that may be a secret
        Duration wait;    ///< for so long at least the receiver wants nothing more; at most kMaxWait
    };

    void add(std::string_view bytes);
    /// Nothing that follows changes the verdict.
    bool complete() const;
    /// By what came until now; nothing: no status did. `now`: for a time until which to wait.
    std::optional<Verdict> verdict(const WebhookAddress& asked,
                                   std::chrono::system_clock::time_point now) const;

  private:
    std::string_view last() const;
    std::string_view body() const;
    std::string_view head(std::string_view name) const;

    std::string text_;
};

}  // namespace asip::registry
