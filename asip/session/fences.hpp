// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "asip/protocol/message.hpp"
#include "asip/random.hpp"

namespace asip::session {

/// A question whose answer proves that the board executed what was sent before it.
struct Fence {
    std::string line;   ///< "#,V,x4T", "#,E,x4T", "#,?" or "#,N"
    std::string token;  ///< empty on a board without the echo extension
    /// The digest in its answer is that of the requests in flight behind the fence before, and of this one.
    bool verifies = false;

    bool sent() const { return !line.empty(); }
    bool is_answered_by(const protocol::Event& event) const;
};

/// The token in the answer to a fence: empty where there is none. And the digest behind it.
std::string_view fence_token(const protocol::Event& event);
std::optional<std::int64_t> fence_digest(const protocol::Event& event);

/// Makes fences. With the echo extension, and with verified fences, each has a token of three letters and
/// digits: the tokens of a session begin at a random one, go in random strides, and do not repeat within
/// 238,328 fences. Without it, two questions take turns.
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
    /// Without the extension: the question of the two that is not `avoid`, by its first three characters.
    Fence next_but(std::string_view avoid);
    /// Whether `line` is one of the questions that serve as fences.
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
