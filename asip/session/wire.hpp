// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "asip/protocol/line_reader.hpp"
#include "asip/session/action.hpp"
#include "asip/time.hpp"

namespace asip::session {

/// The line as bytes: cuts what arrives into lines, adds and removes checksums, and knows the rate.
class Wire {
  public:
    enum class Checksums {
        kOff,
        kTurningOn,  ///< sent with, received with or without: the board has not answered yet
        kOn,
    };
    static constexpr std::size_t kChecksumBytes = 3;

    /// `baud`: 0: none.
    void open(unsigned baud);

    unsigned baud() const { return baud_; }
    unsigned start_baud() const { return start_baud_; }
    bool has_rates() const { return start_baud_ != 0; }
    bool at_start_rate() const { return baud_ == start_baud_; }
    void set_rate(unsigned baud, std::string why, Actions& out);
    /// For one byte; zero: the link has no rate.
    Duration byte_time() const;
    /// A checksum costs less than 0.1 ms a line.
    bool is_fast() const;

    /// Each with a line end. `#,C,1` and `#,C,0` change the form of what follows them.
    void write(const std::vector<std::string>& lines, Actions& out);
    Checksums checksums() const { return checksums_; }
    bool writes_checksums() const { return checksums_ != Checksums::kOff; }
    void forget_checksums() { checksums_ = Checksums::kOff; }
    /// They bring a board to the wanted form from either.
    std::vector<std::string> switching_lines(bool on);

    protocol::LineReader& reader() { return reader_; }
    /// A received line without its checksum. `damaged`: the checksum is missing or wrong.
    struct Received {
        std::string_view text;
        bool damaged = false;
        bool had_checksum = false;
    };
    Received unpack(std::string_view line);

    std::uint64_t bytes_out() const { return bytes_out_; }

  private:
    protocol::LineReader reader_;
    Checksums checksums_ = Checksums::kOff;
    bool had_checksums_ = false;  // since open(): the board may still send them, damaged ones, too
    unsigned start_baud_ = 0;
    unsigned baud_ = 0;
    std::uint64_t bytes_out_ = 0;
};

}  // namespace asip::session
