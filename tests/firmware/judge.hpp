// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace wire {

/// What a service was told to do. `C` (numbers): `C,m,SIGNED[,NUMBER]`. `E` (text): `E,m,NUMBER,TEXT`. `I`,
/// of which digital writes alone are looked at: pin and level.
struct Call {
    char service;
    std::int32_t first;
    std::int32_t second;  ///< -1: there was none
    std::string_view text;
};

/// What a board did with a byte, or in a second of silence.
struct Seen {
    std::string_view sent;
    unsigned calls = 0;
    Call call{};  ///< the last one
    std::uint16_t digest = 0;
};

/// Reads the bytes that a board reads and says whether what the board did is what docs/protocol.md demands:
/// which requests there are, which of them are executed and with which arguments, and which digest stands for
/// them. It was written from that page, without a look at the firmware's parser. Where the page leaves a
/// board the choice, each is right that does not execute anything else than what was sent.
class Judge {
  public:
    static constexpr unsigned kMaxRequest = 62;
    static constexpr unsigned kMaxChecked = 60;  ///< with a checksum

    /// nullptr, or what is wrong.
    const char* byte(std::uint8_t byte, const Seen& seen);
    const char* second_of_silence(const Seen& seen);

    /// Whether a request ends at this byte, or may end there.
    bool may_end_at(std::uint8_t byte) const;

    /// Nothing is known of its bytes besides the state of this object.
    bool line_is_open() const { return length_ != 0 && !lost_; }
    std::string_view text() const { return {text_.data(), length_}; }
    bool uses_checksums() const { return checksums_; }
    std::uint16_t digest() const { return digest_; }
    /// Goes on from another digest; the board has to have the same.
    void take_digest(std::uint16_t digest) { digest_ = digest; }
    static std::uint16_t digest_of(std::uint16_t digest, std::uint8_t byte);
    /// False once something was executed after which more than requests decides what the board does: a mode
    /// of a pin, a period, a line rate on trial.
    bool can_tell() const { return can_tell_; }

  private:
    struct Verdict;

    bool splits_before_last(bool& certain) const;
    const char* end(const Seen& seen, std::string_view request, bool at_line_end);
    const char* end_of_line(const Seen& seen);
    const char* judge(const Verdict& verdict, std::string_view request, const Seen& seen);
    const char* executed(std::string_view request, const Seen& seen);
    const char* refused(const Verdict& verdict, std::string_view request, const Seen& seen);
    Verdict verdict(std::string_view request, bool at_line_end) const;
    Verdict verdict_of_write(std::string_view request) const;
    Verdict verdict_of_system(std::string_view request) const;
    void count(std::string_view request, unsigned error);
    void append(std::uint8_t byte);
    void drop_line();

    std::array<char, kMaxRequest + 18> text_{};
    std::uint8_t length_ = 0;
    bool too_long_ = false;
    bool lost_ = false;  // a zero
    bool extended_ = false;
    bool checksums_ = false;
    bool can_tell_ = true;
    std::uint16_t digest_ = 0;
};

}  // namespace wire
