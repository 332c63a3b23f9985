// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "asip/protocol/message.hpp"
#include "asip/random.hpp"

namespace asip::session {

/// A question whose answer proves that what was sent before it was executed.
struct Fence {
    std::string line;   ///< "#,V,x4T", "#,E,x4T", "#,?" or "#,N"
    std::string token;  ///< empty on a board without the echo extension
    /// Its answer has a digest of this fence and of the requests behind the fence before.
    bool verifies = false;

    bool sent() const { return !line.empty(); }
    bool is_answered_by(const protocol::Event& event) const;
};

/// The token in the answer to a fence, which may be empty; and the digest behind it.
std::string_view fence_token(const protocol::Event& event);
std::optional<std::int64_t> fence_digest(const protocol::Event& event);

/// Makes fences. With the extensions echo and verified fences, each has a token of three letters and digits,
/// which go in random strides from a random beginning and do not repeat within 238,328 fences. Without them,
/// two questions take turns.
class Fences {
  public:
    static constexpr std::size_t kTokenBytes = 3;

    explicit Fences(const Random& random);

    void use_echo(bool verified) {
        echo_ = true;
        verified_ = verified;
    }
    /// Without the extension: `#,?` and `second` in turn.
    void use_questions(std::string second);
    bool echo() const { return echo_; }
    /// The board answers with a digest of what it read.
    bool verified() const { return echo_ && verified_; }

    Fence next();
    /// Without the extension: the question that does not begin with the first three characters of `avoid`.
    Fence next_but(std::string_view avoid);
    bool is_fence_question(std::string_view line) const;

  private:
    static constexpr std::uint32_t kTokens = 62 * 62 * 62;

    bool echo_ = false;
    bool verified_ = false;
    bool second_next_ = false;
    std::string second_;
    std::uint32_t token_;
    std::uint32_t stride_;
};

}  // namespace asip::session
