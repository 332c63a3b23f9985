// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace readers {

/// What became of bytes of a client: a request that goes to the board, or one that is refused.
struct Outcome {
    std::string text;
    bool refused = false;
    bool operator==(const Outcome&) const = default;
};

/// Reads the bytes of a point-to-point client of an agent and says whether the requests that the agent made
/// of them are those of docs/protocol.md and docs/asip-agent.md. It was written from these pages, without a
/// look at the agent's reader. Where they leave the agent the choice, each is right that executes nothing
/// else than what was sent.
class ClientJudge {
  public:
    enum class Framing : std::uint8_t { kUnknown, kLines, kFrames };
    explicit ClientJudge(Framing framing = Framing::kUnknown) : framing_(framing) {}

    /// nullptr, or what is wrong.
    const char* byte(std::uint8_t byte, const std::vector<Outcome>& seen);
    const char* second_of_silence(const std::vector<Outcome>& seen);

    bool line_is_open() const { return !text_.empty() || length_bytes_ != 0; }
    /// Whether a request may end at this byte.
    bool may_end_at(std::uint8_t byte) const;

    bool operator==(const ClientJudge&) const = default;
    std::size_t hash() const;

  private:
    enum class End : std::uint8_t { kLine, kNext, kSilence };

    const char* byte_of_line(std::uint8_t byte, const std::vector<Outcome>& seen);
    const char* byte_of_frame(std::uint8_t byte, const std::vector<Outcome>& seen);
    bool splits_before_last(bool& certain) const;
    const char* end(std::string_view text, End end, const std::vector<Outcome>& seen);

    Framing framing_;
    bool extended_ = false;
    std::uint8_t length_bytes_ = 0;  // of a frame's length, that came
    std::uint32_t length_ = 0;       // of the frame
    std::string text_;               // since the last end
};

}  // namespace readers
